#pragma once
/// Surface of the solid that several closed parts of a mesh enclose together.
#include <cstdint>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"
#include "core/voxmap/closed_shells.hpp"
#include "core/voxmap/grid_mesh.hpp"

namespace voxtouch::voxmap {

/// Faces with solid on both sides do not belong to the surface: the seam of two touching boxes, and
/// the part of a box inside another. Parts within kSeamVoxels of each other touch.
inline constexpr double kSeamVoxels = 1e-4;

/// In grid coordinates. `whole`: the surface is the mesh itself, and the other members are empty.
struct SolidSurface {
  bool whole = true;
  mesh::TriangleMesh mesh;            ///< triangles of the mesh, or their remaining pieces
  std::vector<std::uint32_t> closed;  ///< those of closed parts, ascending
  std::vector<std::uint32_t> open;    ///< those of open parts, ascending
};

/// Cuts the triangles of a patch along other patches and removes pieces with solid on both sides.
/// The winding number of the whole mesh defines the solid (winding.hpp). A mesh is whole if the
/// boxes of its patches do not meet, for example with a single patch. Allocates.
SolidSurface solid_surface(const GridMesh& mesh, const ClosedShells& shells);

/// The same in metres; returns the mesh itself if it is whole. Throws like GridMesh.
mesh::TriangleMesh solid_surface(const mesh::TriangleMesh& mesh, const Grid& grid);

}  // namespace voxtouch::voxmap
