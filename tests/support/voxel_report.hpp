#pragma once
/// What a mesh's triangles and parts are to the voxels: counted for tests by the same functions that `voxelise` asks.
#include <algorithm>

#include "core/voxmap/closed_shells.hpp"
#include "core/voxmap/grid_mesh.hpp"

namespace voxtouch::test {

struct VoxelReport {
  std::size_t zero_area = 0, duplicates = 0;
  voxmap::ClosedShells shells;
  bool inside_out() const { return shells.signed_volume < 0.0; }
};

inline VoxelReport voxel_report(const mesh::TriangleMesh& mesh, const voxmap::Grid& grid) {
  const voxmap::GridMesh in_grid(mesh, grid);
  const std::vector<std::uint32_t> welded = voxmap::weld_vertices(in_grid);
  const std::vector<voxmap::TriangleState> state = voxmap::judge_triangles(in_grid, welded);
  const auto count = [&](voxmap::TriangleState s) { return static_cast<std::size_t>(std::count(state.begin(), state.end(), s)); };
  return {count(voxmap::TriangleState::kZeroArea), count(voxmap::TriangleState::kDuplicate),
          voxmap::find_closed_shells(in_grid, welded, state)};
}

}  // namespace voxtouch::test
