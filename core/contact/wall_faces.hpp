#pragma once
/// Faces of thin walls, which bend the distance field. The plane of the wall's face on the tool's
/// side is fitted to the distances at voxel corners, for eight points at once.
#include <cstddef>

#include "core/types/geometry.hpp"
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::contact {

struct WallFaces {
  static constexpr std::size_t kPoints = 8;
  std::size_t count = 0;  ///< number of points
  /// input: positions in grid coordinates [e]; the tool's own normals there, unit, W axes.
  Vec3 at[kPoints], outward[kPoints];
  bool found[kPoints];    ///< output: whether there is such a face
  Vec3 normal[kPoints];   ///< output: its unit normal, out of the wall, W axes
  double gap_m[kPoints];  ///< output: distance of the point outside the face
};

/// Computes the outputs. Point by point bit-identical on every processor. Real-time safe.
/// The plane n.x = c is fitted three times, coarsely first (limits::kSheetCoarse), to the corners
/// of the point's voxel and of the one an edge farther along `outward`. There is no face if too few
/// corners are on this side, or if the plane disagrees with `outward`. The projection of the point
/// must not be nearer to a corner than that corner's distance (the rim of the face). The depth must
/// not increase one edge farther in (a thick body).
void find_wall_faces(const voxmap::DistanceField& field, WallFaces& faces) noexcept;

}  // namespace voxtouch::contact
