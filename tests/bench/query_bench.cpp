// Times of the contact query and of the steps after its hits, by place and number of points,
// compared with reading 12 bytes per point, the lower bound of any query that visits every point.
// Ratios count; run by deploy/bench.
#include <numbers>

#include "core/contact/contact_renderer.hpp"
#include "core/voxmap/distance_field.hpp"
#include "core/voxmap/voxelise.hpp"
#include "tests/bench/bench_mesh.hpp"
#include "tests/bench/bench_sizes.hpp"
#include "tests/bench/choose_instructions.hpp"
#include "tests/bench/flat_query.hpp"
#include "tests/bench/read_floor.hpp"
#include "tests/bench/run_benchmarks.hpp"

namespace voxtouch::bench {
namespace {

const voxmap::Voxmap& ground() {
  static const voxmap::Voxmap map = cup();
  return map;
}

/// The cup from a mesh, for `field` and the virtual tool, which query distances. It has other
/// surface voxels, so it has separate rows.
struct Ground {
  voxmap::Voxmap map;
  voxmap::DistanceField field;
};
const Ground& ground_of_mesh() {
  static const Ground made = [] {
    const mesh::TriangleMesh mesh = cup_mesh(20'000);
    voxmap::Voxmap map =
        voxmap::voxelise(mesh, {kEdge * Vec3(0.06, 0.08, 0.1), kEdge}, serial_for());
    voxmap::DistanceField field = voxmap::build_distance_field(mesh, map, {}, serial_for());
    return Ground{std::move(map), std::move(field)};
  }();
  return made;
}

void count(benchmark::State& state, std::size_t points, double tested, double hits) {
  const auto frames = static_cast<double>(state.iterations());
  state.counters["ns/point"] =
      benchmark::Counter(static_cast<double>(points) * 1e-9 * frames,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["tested%"] = 100.0 * tested / frames / static_cast<double>(points);
  state.counters["hits%"] = 100.0 * hits / frames / static_cast<double>(points);
}

void read_12_bytes(benchmark::State& state, std::size_t points) {
  const ReadFloor floor(points);
  for (auto _ : state)
    benchmark::DoNotOptimize(floor.read());
  count(state, points, 0.0, 0.0);
}

void find(benchmark::State& state, const voxmap::Voxmap& map, Place place,
          const std::vector<Pose>& poses, std::size_t points) {
  const contact::ContactQuery query(map, tool(place, points));
  contact::HitList hits;
  hits.reserve(points);
  double tested = 0.0, hit = 0.0;
  std::size_t n = 0;
  for (auto _ : state) {
    query.find(poses[n++ % poses.size()], hits);
    tested += hits.tested, hit += static_cast<double>(hits.surface.size() + hits.interior.size());
  }
  count(state, points, tested, hit);
}

void flat(benchmark::State& state, Place place, std::size_t points) {
  const pointshell::Pointshell shell = tool(place, points);
  const FlatQuery query(ground(), shell);
  const std::vector<Pose> poses = path(place);
  std::vector<std::uint32_t> hits;
  double hit = 0.0;
  std::size_t n = 0;
  for (auto _ : state)
    hit += static_cast<double>(query.find(poses[n++ % poses.size()], hits));
  count(state, points, static_cast<double>(points * n), hit);
}

void render(benchmark::State& state, const voxmap::Voxmap& map, Place place, std::size_t points,
            contact::ContactModelKind model, const voxmap::DistanceField* field) {
  contact::ContactRenderer renderer(map, tool(place, points), model,
                                    {1.0, contact::PointWeights::kArea}, field);
  const std::vector<Pose> poses = path(place);
  double tested = 0.0, hit = 0.0;
  std::size_t n = 0;
  for (auto _ : state) {
    const contact::ContactResult contact = renderer.render(poses[n++ % poses.size()]).contact;
    tested += contact.points_tested, hit += contact.surface_hits + contact.interior_hits;
  }
  count(state, points, tested, hit);
}

/// The hand's ball circles on the cup's floor at 0.1 m/s, 2 mm too deep, forward and back, so that
/// no frame is a jump.
std::vector<Pose> slide(double too_deep_voxels) {
  constexpr double kRound = 16.0, kStep = 0.2;  // [voxels]
  std::vector<Pose> out;
  const int frames = static_cast<int>(2.0 * std::numbers::pi * kRound / kStep);
  const Quat turned(Eigen::AngleAxisd(0.7, Vec3(0.2, 0.7, 0.4).normalized()));
  for (int n = 0; n < frames; ++n) {
    const double angle = 2.0 * std::numbers::pi * n / frames;
    out.push_back({kEdge * Vec3(kRound * std::cos(angle), kRound * std::sin(angle),
                                kFloor + kBall - too_deep_voxels),
                   turned});
  }
  return out;
}

void add_all() {
  using contact::ContactModelKind;
  for (const std::size_t points : {1000U, 10'000U, 100'000U, 1'000'000U}) {
    const std::string size = "/" + std::to_string(points);
    benchmark::RegisterBenchmark(("read 12 bytes a point" + size).c_str(), read_12_bytes, points);
    for (const Place place : {Place::kFar, Place::kNear, Place::kLight, Place::kHeavy}) {
      const std::string row = "/" + name_of(place) + size;
      benchmark::RegisterBenchmark(("find" + row).c_str(), [=](benchmark::State& state) {
        find(state, ground(), place, path(place), points);
      });
      benchmark::RegisterBenchmark(("flat loops" + row).c_str(),
                                   [=](benchmark::State& state) { flat(state, place, points); });
      for (const auto model : {ContactModelKind::kOriginal, ContactModelKind::kAdapted})
        benchmark::RegisterBenchmark(
            ("render " + std::string(contact::name_of(model)) + row).c_str(),
            [=](benchmark::State& state) {
              render(state, ground(), place, points, model, nullptr);
            });
      if (place == Place::kFar)
        continue;
      for (const auto model : {ContactModelKind::kAdapted, ContactModelKind::kField})
        benchmark::RegisterBenchmark(
            ("of mesh " + std::string(contact::name_of(model)) + row).c_str(),
            [=](benchmark::State& state) {
              render(state, ground_of_mesh().map, place, points, model, &ground_of_mesh().field);
            });
    }
    if (points > 100'000)
      continue;
    benchmark::RegisterBenchmark(("find/slide" + size).c_str(), [=](benchmark::State& state) {
      find(state, ground_of_mesh().map, Place::kLight, slide(0.0), points);
    });
  }
}

}  // namespace
}  // namespace voxtouch::bench

int main(int argc, char** argv) {
  voxtouch::bench::choose_instructions(argc, argv);
  voxtouch::bench::add_all();
  return voxtouch::bench::run_benchmarks(argc, argv);
}
