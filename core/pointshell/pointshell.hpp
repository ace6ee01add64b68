#pragma once
/// The dynamic object as the contact models see it: points on its surface with inward normals
/// (paper, section 2.1).
#include <cstdint>
#include <vector>

#include "core/types/geometry.hpp"

namespace voxtouch::pointshell {

/// Structure of arrays in Morton order of the points' voxels, so that neighbours in space are
/// neighbours in memory. All in frame T. `id` is the point's rank among the surface voxels sorted
/// by (i, j, k): the order of files and reports.
struct Pointshell {
  std::vector<double> x, y, z;     ///< position [m]
  std::vector<double> nx, ny, nz;  ///< unit normal, pointing INTO the dynamic object
  /// the point's fraction of the surface, its weight [m^2]; all of them sum to the mesh's area
  std::vector<double> area_m2;
  /// |sum A n| / sum A over the voxel's triangles; 1 = flat, 0 = normals cancel
  std::vector<double> coherence;
  std::vector<std::uint32_t> id;  ///< rank among the sorted surface voxels
  double edge = 0.0;              ///< voxel edge the shell was built with [m]

  std::size_t size() const noexcept { return x.size(); }
  Vec3 point(std::size_t p) const { return {x[p], y[p], z[p]}; }
  Vec3 normal(std::size_t p) const { return {nx[p], ny[p], nz[p]}; }
};

}  // namespace voxtouch::pointshell
