// Growth with the scene: a frame, a map, distances and a shell, by the number of triangles (to 1e7)
// and the resolution (to 2048^3), with bytes per surface voxel, points tested, and peak memory. All
// rows take some minutes and 4 GB.
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>

#include "core/contact/contact_query.hpp"
#include "core/pointshell/build_shell.hpp"
#include "core/voxmap/distance_field.hpp"
#include "core/voxmap/voxelise.hpp"
#include "tests/bench/bench_mesh.hpp"
#include "tests/bench/choose_instructions.hpp"
#include "tests/bench/run_benchmarks.hpp"
#include "tests/bench/scale_scene.hpp"

namespace voxtouch::bench {
namespace {

struct Size {
  std::size_t triangles;
  int resolution;
  bool operator==(const Size&) const = default;
};

/// The last one: rows of one size are consecutive, and two of the largest would not fit.
struct Ground {
  Size size;
  mesh::TriangleMesh mesh;
  std::unique_ptr<voxmap::Voxmap> map;
};
Ground& ground_of(const Size& size, bool with_map) {
  static Ground last{};
  if (!(last.size == size))
    last = {}, last = {size, cup_mesh(size.triangles), nullptr};
  if (with_map && !last.map)
    last.map = std::make_unique<voxmap::Voxmap>(
        voxmap::voxelise(last.mesh, grid_of(size.resolution), serial_for()));
  return last;
}

/// Largest resident memory of this process since it was made zero [MB]; Linux alone.
void forget_peak() { std::ofstream("/proc/self/clear_refs") << "5"; }
double peak_mb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:"))
      return std::stod(line.substr(6)) / 1024.0;
  return 0.0;
}

void print_map(benchmark::State& state, const voxmap::Voxmap& map, std::size_t bytes) {
  state.counters["surface"] = static_cast<double>(map.surface_count());
  state.counters["B/voxel"] = static_cast<double>(bytes) / static_cast<double>(map.surface_count());
  state.counters["peakMB"] = peak_mb();
}

void voxels(benchmark::State& state, const Size& size) {
  Ground& ground = ground_of(size, false);
  ground.map.reset();
  forget_peak();
  for (auto _ : state) {
    ground.map.reset();
    ground_of(size, true);
  }
  print_map(state, *ground.map, ground.map->bytes());
}

void distances(benchmark::State& state, const Size& size) {
  const Ground& ground = ground_of(size, true);
  std::size_t bytes = 0;
  forget_peak();
  for (auto _ : state)
    bytes = voxmap::build_distance_field(ground.mesh, *ground.map, {}, serial_for(),
                                         std::uint64_t{16} << 30)
                .bytes();
  print_map(state, *ground.map, bytes);
}

void shell(benchmark::State& state, const Size& size) {
  const Ground& ground = ground_of(size, false);
  std::size_t points = 0;
  forget_peak();
  for (auto _ : state)
    points = pointshell::make_exact_shell(
                 pointshell::shell_points(ground.mesh, grid_of(size.resolution), serial_for()),
                 grid_of(size.resolution))
                 .size();
  state.counters["points"] = static_cast<double>(points);
  state.counters["peakMB"] = peak_mb();
}

void find(benchmark::State& state, const Size& size, Place place) {
  constexpr std::size_t kPoints = 10'000;
  const Ground& ground = ground_of(size, true);
  const contact::ContactQuery query(*ground.map, tool(place, kPoints));
  contact::HitList hits;
  hits.reserve(kPoints);
  const std::vector<Pose> poses = path(place);
  std::size_t n = 0;
  for (auto _ : state)
    query.find(poses[n++ % poses.size()], hits);
  const FrameCounts counts = frame_counts(*ground.map, place, kPoints);
  state.counters["tested"] = counts.tested, state.counters["hits"] = counts.not_free,
  state.counters["groups"] = counts.looked_at;
}

void add_rows(const std::string& of, const Size& size, bool with_distances, bool with_shell) {
  const auto add = [&](const char* what, auto run, benchmark::TimeUnit unit) {
    benchmark::RegisterBenchmark((what + of).c_str(), run)->Unit(unit);
  };
  add(
      "voxels", [size](benchmark::State& state) { voxels(state, size); }, benchmark::kMillisecond);
  for (const Place place : {Place::kNear, Place::kLight, Place::kHeavy})
    add(("find " + name_of(place)).c_str(),
        [size, place](benchmark::State& state) { find(state, size, place); },
        benchmark::kMicrosecond);
  if (with_distances)
    add(
        "distances", [size](benchmark::State& state) { distances(state, size); },
        benchmark::kMillisecond);
  if (with_shell)
    add(
        "shell", [size](benchmark::State& state) { shell(state, size); }, benchmark::kMillisecond);
}

}  // namespace
}  // namespace voxtouch::bench

int main(int argc, char** argv) {
  using namespace voxtouch::bench;
  choose_instructions(argc, argv);
  for (const std::size_t triangles : {1'000U, 10'000U, 100'000U, 1'000'000U, 10'000'000U})
    add_rows("/triangles/" + std::to_string(triangles), {triangles, 256}, triangles <= 1'000'000,
             true);
  for (const int resolution : {128, 256, 512, 1024, 2048})
    add_rows("/resolution/" + std::to_string(resolution), {10'000, resolution}, resolution <= 1024,
             resolution <= 1024);
  return run_benchmarks(argc, argv);
}
