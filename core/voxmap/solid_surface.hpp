#pragma once
/// Of several closed parts of a mesh, the surface of the solid that they enclose together.
#include <cstdint>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"
#include "core/voxmap/closed_shells.hpp"
#include "core/voxmap/grid_mesh.hpp"

namespace voxtouch::voxmap {

/// Faces with solid on both sides are no surface: the seam of two boxes that touch, and what of a
/// box lies within another. Parts no farther apart than kSeamVoxels touch.
inline constexpr double kSeamVoxels = 1e-4;

/// Grid coordinates. `whole`: the surface is the mesh itself, and the rest is empty.
struct SolidSurface {
  bool whole = true;
  mesh::TriangleMesh mesh;  ///< triangles of the mesh, or the pieces of them that are left
  std::vector<std::uint32_t> closed;  ///< those of closed parts, ascending
  std::vector<std::uint32_t> open;    ///< those of open parts, ascending
};

/// Triangles of a patch that another patch meets are cut where it does; pieces with solid on both
/// sides are left out. Where it is solid is the winding number of the whole mesh (winding.hpp).
/// Whole is a mesh whose patches' boxes do not meet, one of a single patch among them. Allocates.
SolidSurface solid_surface(const GridMesh& mesh, const ClosedShells& shells);

/// The same in metres: the mesh itself where it is whole. Throws like GridMesh.
mesh::TriangleMesh solid_surface(const mesh::TriangleMesh& mesh, const Grid& grid);

}  // namespace voxtouch::voxmap
