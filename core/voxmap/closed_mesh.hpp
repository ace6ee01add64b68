#pragma once
/// The closed parts of a mesh in grid coordinates, and the trees over their triangles, made once
/// for all distance queries.
#include <optional>

#include "core/voxmap/closed_shells.hpp"
#include "core/voxmap/distance_tree.hpp"
#include "core/voxmap/grid_mesh.hpp"
#include "core/voxmap/solid_surface.hpp"

namespace voxtouch::voxmap {

struct ClosedMesh {
  /// `mesh` must outlive it. Throws like GridMesh.
  ClosedMesh(const mesh::TriangleMesh& mesh, const Grid& grid)
      : in_grid(mesh, grid),
        shells(find_closed_shells(in_grid)),
        tree(in_grid, triangles_of_closed_parts(shells)),
        solid(solid_surface(in_grid, shells)) {
    if (solid.whole)
      return;
    left.emplace(solid.mesh, Grid{Vec3::Zero(), 1.0});
    left_tree.emplace(*left, solid.closed);
  }
  ClosedMesh(const ClosedMesh&) = delete;
  ClosedMesh& operator=(const ClosedMesh&) = delete;

  /// The surface for distances: that of all closed parts together.
  const DistanceTree& surface() const noexcept { return solid.whole ? tree : *left_tree; }

  GridMesh in_grid;
  ClosedShells shells;
  DistanceTree tree;  ///< of the whole mesh, for ray intersections
  SolidSurface solid;
  std::optional<GridMesh> left;           ///< of `solid`, if it is not whole
  std::optional<DistanceTree> left_tree;  ///< of `solid`, if it is not whole
};

}  // namespace voxtouch::voxmap
