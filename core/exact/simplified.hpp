#pragma once
/// Fewer triangles for the same surface: flat regions are merged, and finely meshed curved ones
/// within a bound.
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"

namespace voxtouch::exact {

struct SimplifyBounds {
  double distance_m = 0.0;           ///< between both surfaces
  double normal_rotation_rad = 0.0;  ///< of a normal
};

struct SimplifiedMesh {
  mesh::TriangleMesh mesh;               ///< its vertices are vertices of the given mesh
  std::vector<std::uint32_t> triangles;  ///< of each: the number of a given triangle at its place
};

/// Collapses edges onto one of their ends (Hoppe 1996) where the vertices and the middles of the
/// edges of the given mesh stay within the bounds of the result. Rims, edges of more than two
/// faces, and borders between owners remain as they are. The distance is of samples: between them
/// it may be slightly larger.
///
/// `welded`: a mesh whose triangles share vertices. `owners`: of each triangle; empty: all have
/// one. Deterministic. Allocates.
SimplifiedMesh simplify(const mesh::TriangleMesh& welded, std::span<const std::uint32_t> owners,
                        const SimplifyBounds& bounds);

}  // namespace voxtouch::exact
