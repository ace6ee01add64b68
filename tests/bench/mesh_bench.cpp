// Time of our contact query and of FCL and Bullet, on the same two meshes at the same poses, by the
// number of triangles. The results differ: ours has forces of all points, FCL pairs of triangles,
// Bullet pairs in single precision. Run by deploy/bench.
#include <map>

#include "core/contact/contact_renderer.hpp"
#include "core/pointshell/build_shell.hpp"
#include "core/voxmap/voxelise.hpp"
#include "tests/bench/bench_mesh.hpp"
#include "tests/bench/others.hpp"
#include "tests/bench/run_benchmarks.hpp"

namespace voxtouch::bench {
namespace {

/// Data of a place for either library, built once.
struct Pair {
  mesh::TriangleMesh still, moving;
  voxmap::Voxmap ground;
  pointshell::Pointshell shell;
};

const Pair& pair_of(Place place, std::size_t triangles) {
  static std::map<std::pair<Place, std::size_t>, Pair> made;
  const auto key = std::pair{place, triangles};
  if (const auto found = made.find(key); found != made.end())
    return found->second;
  Pair pair{cup_mesh(triangles), tool_mesh(place, triangles), {}, {}};
  pair.ground = voxmap::voxelise(pair.still, {kEdge * Vec3(0.06, 0.08, 0.1), kEdge}, serial_for());
  const voxmap::Grid own = voxmap::default_grid(pair.moving, kEdge);
  pair.shell =
      pointshell::make_exact_shell(pointshell::shell_points(pair.moving, own, serial_for()), own);
  return made.emplace(key, std::move(pair)).first->second;
}

template <class Ask>
void run(benchmark::State& state, const Pair& pair, Place place, Ask ask) {
  const std::vector<Pose> poses = eight_poses(place);  // some libraries take long for one
  double found = 0.0;
  for (auto _ : state)
    for (const Pose& pose : poses)
      found += ask(pose);
  const double queries =
      static_cast<double>(state.iterations()) * static_cast<double>(poses.size());
  state.counters["s/query"] =
      benchmark::Counter(queries, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["found"] = found / queries;
  state.counters["triangles"] = static_cast<double>(pair.still.triangles.size());
  state.counters["points"] = static_cast<double>(pair.shell.size());
}

void ours(benchmark::State& state, Place place, std::size_t triangles, bool only_find) {
  const Pair& pair = pair_of(place, triangles);
  contact::ContactRenderer renderer(pair.ground, pair.shell, contact::ContactModelKind::kAdapted,
                                    {1.0});
  contact::HitList hits;
  hits.reserve(pair.shell.size());
  run(state, pair, place, [&](const Pose& pose) {
    if (!only_find) {
      const contact::ContactResult contact = renderer.render(pose).contact;
      return static_cast<double>(contact.surface_hits + contact.interior_hits);
    }
    renderer.query().find(pose, hits);
    return static_cast<double>(hits.surface.size() + hits.interior.size());
  });
}

void theirs(benchmark::State& state, Place place, std::size_t triangles,
            const std::function<std::unique_ptr<OtherPair>(const Pair&)>& make) {
  const Pair& pair = pair_of(place, triangles);
  const std::unique_ptr<OtherPair> other = make(pair);
  if (!other)
    return state.SkipWithError("libbullet-dev was not there when this was built");
  run(state, pair, place, [&](const Pose& pose) { return other->ask(pose); });
}

void add_all() {
  const auto fcl = [](FclQuestion question) {
    return [question](const Pair& p) { return fcl_pair(p.still, p.moving, question); };
  };
  for (const std::size_t triangles : {1000U, 10'000U, 100'000U})
    for (const Place place : {Place::kNear, Place::kLight, Place::kHeavy}) {
      const std::string row = "/" + name_of(place) + "/" + std::to_string(triangles);
      const auto add = [&](const std::string& what,
                           const std::function<std::unique_ptr<OtherPair>(const Pair&)>& make) {
        benchmark::RegisterBenchmark((what + row).c_str(), theirs, place, triangles, make);
      };
      benchmark::RegisterBenchmark(("find" + row).c_str(), ours, place, triangles, true);
      benchmark::RegisterBenchmark(("render" + row).c_str(), ours, place, triangles, false);
      add("fcl boolean", fcl(FclQuestion::kBoolean));
      add("fcl contacts", fcl(FclQuestion::kAllContacts));
      add("fcl distance", fcl(FclQuestion::kDistance));
      add("gimpact", [](const Pair& p) { return gimpact_pair(p.still, p.moving); });
    }
}

}  // namespace
}  // namespace voxtouch::bench

int main(int argc, char** argv) {
  voxtouch::bench::add_all();
  return voxtouch::bench::run_benchmarks(argc, argv);
}
