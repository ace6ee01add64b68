#pragma once
/// Signed distance to the static surface, interpolated below one voxel: what the contact model `field` looks up.
#include <cstddef>

#include "core/mesh/triangle_mesh.hpp"
#include "core/types/parallel.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch {

/// What the field says about one point.
struct FieldSample {
  double distance_m = 0.0;        ///< interpolated signed distance [m], negative inside
  Vec3 gradient = Vec3::Zero();   ///< of the interpolation, W axes; about unit length, pointing out of the static object
  bool known = false;             ///< false: too far from the surface for the field to hold a distance
  bool saturated = false;         ///< inside, deeper than the field holds: `distance_m` is a bound that does not grow further
};

/// How much of the field is stored.
struct DistanceFieldOptions {
  double depth_voxels = 12.0;  ///< inside, distances are held down to at least this depth
};

class DistanceField {
 public:
  /// Sample at the grid coordinates u = (x - origin) / e of the voxmap's grid. Continuous in u. Real-time safe.
  FieldSample at(const Vec3& u) const noexcept;
  std::size_t bytes() const noexcept;
};

/// The field of the mesh that `voxmap` was made from. Signs come from the voxmap's flood fill, distances from the triangles.
/// Same bits whatever `parallel_for` does.
DistanceField build_distance_field(const TriangleMesh& mesh, const Voxmap& voxmap, const DistanceFieldOptions& options,
                                   const ParallelFor& parallel_for);

}  // namespace voxtouch
