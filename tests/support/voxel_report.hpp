#pragma once
/// Counts a mesh's triangles and parts for tests, with the functions that `voxelise` uses.
#include <algorithm>

#include "core/voxmap/closed_shells.hpp"
#include "core/voxmap/grid_mesh.hpp"

namespace voxtouch::test {

struct VoxelReport {
  std::size_t zero_area = 0, duplicates = 0;
  voxmap::ClosedShells shells;
  double volume = 0.0;  ///< of the oriented closed parts [voxels]; negative: the mesh is inside out
  bool inside_out() const { return volume < 0.0; }
  /// Triangles of this role.
  std::size_t count(voxmap::ShellRole role) const {
    return static_cast<std::size_t>(std::count(shells.role.begin(), shells.role.end(), role));
  }
};

inline VoxelReport voxel_report(const mesh::TriangleMesh& mesh, const voxmap::Grid& grid) {
  const voxmap::GridMesh in_grid(mesh, grid);
  const std::vector<std::uint32_t> welded = voxmap::weld_vertices(in_grid);
  const std::vector<voxmap::TriangleState> state = voxmap::judge_triangles(in_grid, welded);
  const auto count = [&](voxmap::TriangleState s) {
    return static_cast<std::size_t>(std::count(state.begin(), state.end(), s));
  };
  VoxelReport report{count(voxmap::TriangleState::kZeroArea),
                     count(voxmap::TriangleState::kDuplicate),
                     voxmap::find_closed_shells(in_grid, welded, state)};
  for (std::uint32_t t = 0; t < in_grid.size(); ++t) {
    const voxmap::ShellRole role = report.shells.role[t];
    if (role != voxmap::ShellRole::kKept && role != voxmap::ShellRole::kFlipped)
      continue;
    const Vec3 at =
        in_grid.u[mesh.triangles[0][0]];  // near the mesh, so that cancellation is small
    const double six = (in_grid.corner(t, 0) - at)
                           .dot((in_grid.corner(t, 1) - at).cross(in_grid.corner(t, 2) - at));
    report.volume += static_cast<double>(role) * six / 6.0;
  }
  return report;
}

}  // namespace voxtouch::test
