// Time from a mesh to a displayable scene, in one thread, compared with OpenVDB's signed distances
// of the same mesh on an equal grid. Run by deploy/bench.
#include <map>

#include "core/pointshell/build_shell.hpp"
#include "core/voxmap/distance_field.hpp"
#include "core/voxmap/voxelise.hpp"
#include "tests/bench/bench_mesh.hpp"
#include "tests/bench/others.hpp"
#include "tests/bench/run_benchmarks.hpp"

namespace voxtouch::bench {
namespace {

const mesh::TriangleMesh& cup_of(std::size_t triangles) {
  static std::map<std::size_t, mesh::TriangleMesh> made;
  const auto found = made.find(triangles);
  return found != made.end() ? found->second
                             : made.emplace(triangles, cup_mesh(triangles)).first->second;
}

void print(benchmark::State& state, std::size_t triangles, std::size_t bytes) {
  state.counters["bytes"] = static_cast<double>(bytes);
  state.counters["triangles"] = static_cast<double>(cup_of(triangles).triangles.size());
}

voxmap::Voxmap voxels_of(std::size_t triangles) {
  return voxmap::voxelise(cup_of(triangles), {kEdge * Vec3(0.06, 0.08, 0.1), kEdge}, serial_for());
}

void voxels(benchmark::State& state, std::size_t triangles) {
  std::size_t bytes = 0;
  cup_of(triangles);
  for (auto _ : state)
    bytes = voxels_of(triangles).bytes();
  print(state, triangles, bytes);
}

void distances(benchmark::State& state, std::size_t triangles) {
  std::size_t bytes = 0;
  cup_of(triangles);
  for (auto _ : state) {
    const voxmap::Voxmap map = voxels_of(triangles);
    bytes = map.bytes() +
            voxmap::build_distance_field(cup_of(triangles), map, {}, serial_for()).bytes();
  }
  print(state, triangles, bytes);
}

void shell(benchmark::State& state, std::size_t triangles) {
  const voxmap::Grid grid = voxmap::default_grid(cup_of(triangles), kEdge);
  std::size_t points = 0;
  for (auto _ : state)
    points = pointshell::make_exact_shell(
                 pointshell::shell_points(cup_of(triangles), grid, serial_for()), grid)
                 .size();
  print(state, triangles, 0);
  state.counters["points"] = static_cast<double>(points);
}

void openvdb(benchmark::State& state, std::size_t triangles) {
  std::size_t bytes = 0;
  cup_of(triangles);
  for (auto _ : state)
    bytes = openvdb_distances(cup_of(triangles), kEdge, 3.0);
  if (bytes == 0)
    return state.SkipWithError("libopenvdb-dev was not there when this was built");
  print(state, triangles, bytes);
}

}  // namespace
}  // namespace voxtouch::bench

int main(int argc, char** argv) {
  using namespace voxtouch::bench;
  constexpr std::pair<const char*, void (*)(benchmark::State&, std::size_t)> kRows[] = {
      {"voxels", voxels},
      {"voxels and distances", distances},
      {"shell", shell},
      {"openvdb", openvdb}};
  for (const std::size_t triangles : {1000U, 10'000U, 100'000U, 1'000'000U})
    for (const auto& [name, what] : kRows)
      benchmark::RegisterBenchmark(
          (std::string(name) + "/cup/" + std::to_string(triangles)).c_str(), what, triangles)
          ->Unit(benchmark::kMillisecond);
  return run_benchmarks(argc, argv);
}
