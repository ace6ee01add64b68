#pragma once
/// The voxel plane below one voxel: what the surface voxels round a point say together about where the surface is.
#include "core/types/geometry.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch::contact {

/// `original` and `adapted` lay the plane through the centre of the voxel that holds the point, which jumps by an edge at every border.
/// Here the 27 voxels round the point count, each with its weight w_v of the quadratic B-spline about the point, which is
/// continuous with its slope: the offset is sum_surface w_v (c_v - x) / sum_surface w_v. Over a flat layer one voxel thick that is exact
/// from half an edge above its middle to one and a half below.
struct BlendedPlane {
  Vec3 offset = Vec3::Zero();  ///< from the point to the middle of the layer near it [e]
  double surface = 0.0;        ///< sum of the weights of surface voxels, 0..1
  double interior = 0.0;       ///< of interior voxels
  /// 1, falling to 0 at the border of a free voxel: what changes as a point leaves the layer may not jump.
  double inside = 1.0;

  /// Depth along the unit vector `direction` [e], negative above the layer's middle. Where no surface voxel is near any more it
  /// goes over into the constant contact_limits::kDeepEdges, on the interior's side only.
  double depth(const Vec3& direction) const noexcept;
};

/// At `u` in grid coordinates. Real-time safe.
BlendedPlane blended_plane(const voxmap::Voxmap& voxmap, const Vec3& u) noexcept;

}  // namespace voxtouch::contact
