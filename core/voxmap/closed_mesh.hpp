#pragma once
/// The closed parts of a mesh in grid coordinates, and the tree over their triangles: made once for
/// all that asks distances of them.
#include "core/voxmap/closed_shells.hpp"
#include "core/voxmap/distance_tree.hpp"
#include "core/voxmap/grid_mesh.hpp"

namespace voxtouch::voxmap {

struct ClosedMesh {
  /// `mesh` must outlive it. Throws like GridMesh.
  ClosedMesh(const mesh::TriangleMesh& mesh, const Grid& grid)
      : in_grid(mesh, grid),
        shells(find_closed_shells(in_grid)),
        tree(in_grid, triangles_of_closed_parts(shells)) {}
  ClosedMesh(const ClosedMesh&) = delete;
  ClosedMesh& operator=(const ClosedMesh&) = delete;

  GridMesh in_grid;
  ClosedShells shells;
  DistanceTree tree;
};

}  // namespace voxtouch::voxmap
