#pragma once
/// Smallest thickness of a static object. The force grows up to half of that depth.
#include <cstdint>

#include "core/mesh/triangle_mesh.hpp"
#include "core/types/parallel.hpp"
#include "core/voxmap/grid.hpp"

namespace voxtouch::voxmap {

struct ClosedMesh;

/// The thinnest place found.
struct ThinnestWall {
  double thickness_m = 0.0;    ///< [m]; infinite without an interior
  std::uint32_t triangle = 0;  ///< triangle of the mesh on one of its sides
};

/// Finds the thinnest wall with rays from a point of each triangle along its normal to the point
/// where the winding number returns to 0. Walls inside overlapping parts and the orientation of
/// triangles thus have no influence. Above `most_rays` triangles only every n-th is used. The
/// result is an estimate for messages, not a bound: a place thinner than its triangles are wide may
/// be missed.
ThinnestWall thinnest_wall(const ClosedMesh& mesh, const Grid& grid,
                           const ParallelFor& parallel_for, std::size_t most_rays = 50'000);

}  // namespace voxtouch::voxmap
