#pragma once
/// Faces of thin walls, which bend the distance field: the plane of the wall's face on the tool's
/// side, fitted to the distances at voxels' corners, for eight points at once.
#include <cstddef>

#include "core/types/geometry.hpp"
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::contact {

struct WallFaces {
  static constexpr std::size_t kPoints = 8;
  std::size_t count = 0;               ///< points
  Vec3 at[kPoints], outward[kPoints];  ///< asked: places in grid coordinates [e]; the tool's own
                                       ///< normals there, unit, W axes
  bool found[kPoints];                 ///< reported: whether there is such a face, and ...
  Vec3 normal[kPoints];                ///< ... its unit normal, out of the wall, and ...
  double gap_m[kPoints];               ///< ... how far the point is outside of it
};

/// Fills in what is reported. The plane n.x = c is fitted three times, coarsely first
/// (limits::kSheetCoarse), to the corners of the point's voxel and of the one an edge farther along
/// `outward`. There is none where too few corners are on this side, where it disagrees with
/// `outward`, where the point's foot on it lies nearer to a corner than that corner's distance (the
/// face's rim), and where one is deeper an edge farther in (a thick body). Point by point
/// bit-identical on every processor. Real-time safe.
void find_wall_faces(const voxmap::DistanceField& field, WallFaces& faces) noexcept;

}  // namespace voxtouch::contact
