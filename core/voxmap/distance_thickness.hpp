#pragma once
/// How thick a static object is at its thinnest: half of that is how deep a push can grow before it
/// turns over.
#include <cstdint>

#include "core/mesh/triangle_mesh.hpp"
#include "core/types/parallel.hpp"
#include "core/voxmap/grid.hpp"

namespace voxtouch::voxmap {

struct ClosedMesh;

/// The thinnest place found.
struct ThinnestWall {
  double thickness_m = 0.0;    ///< [m]; infinite where nothing is inside
  std::uint32_t triangle = 0;  ///< of the mesh, on one side of it
};

/// Straight through the solid, from a point of each triangle along its normal to where the winding
/// number comes back to 0. So walls inside overlapping parts do not count, nor does which way
/// triangles face. Above `most_rays` triangles only every n-th is looked at; an estimate for
/// people, no bound: a place thinner than its triangles are wide may be missed.
ThinnestWall thinnest_wall(const ClosedMesh& mesh, const Grid& grid,
                           const ParallelFor& parallel_for, std::size_t most_rays = 50'000);

}  // namespace voxtouch::voxmap
