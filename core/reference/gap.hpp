#pragma once
/// Result of the reference for one pose of the tool.
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/types/geometry.hpp"

namespace voxtouch::reference {

/// Angle between two vectors [rad].
inline double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Method of a gap, from the most to the least accurate.
enum class GapMethod : std::uint8_t {
  kNone,         ///< the pose was not finite; no result
  kClosedForm,   ///< sphere against declared primitives, by their closed forms
  kSphereMesh,   ///< sphere against triangles: FCL distance of the centre, sign by the winding
                 ///< number
  kMeshMesh,     ///< two separate meshes: FCL distance
  kVertexDepth,  ///< two meshes that overlap: depth of the deepest vertex, a lower bound
};

/// Signed distance between the dynamic and the static object, with related values. World frame,
/// metres.
struct GapResult {
  /// Signed distance s: > 0 separate; < 0 minus the depth. Exact up to the chord error, except if
  /// `depth_exact` is false.
  double gap_m = std::numeric_limits<double>::quiet_NaN();
  /// Lower bound of the depth that some point of the dynamic object's surface has below the static
  /// surface; 0 without overlap. At most -gap_m, and less if the static object is thinner than the
  /// depth of the sphere. It proves that some shell point must collide.
  double inside_depth_m = 0.0;
  /// Lower bound of the depth of the whole cap of the sphere within sqrt(3) e of its deepest point
  /// (evaluated at the pole and at six points of the rim). 0 if a part of it is outside, and for
  /// meshes. An exact shell has a point in every such cap.
  double cap_inside_depth_m = 0.0;
  Vec3 nearest_static = Vec3::Zero();   ///< on the static surface
  Vec3 nearest_dynamic = Vec3::Zero();  ///< on the dynamic surface
  Vec3 direction = Vec3::Zero();  ///< Unit direction of the static object's force on the dynamic
                                  ///< one; zero if unknown.
  double sphere_radius_m = 0.0;   ///< radius of the dynamic sphere; 0 for a mesh
  /// `direction` represents the whole contact patch, not one of several faces. False if no contact
  /// is possible.
  bool unique_face = false;
  bool depth_exact = false;  ///< depth and gap coincide: a single, sufficiently thick face
  bool inside_known = true;  ///< false: the static mesh is open or inconsistent and has no interior
  GapMethod method = GapMethod::kNone;
  bool self_check =
      false;  ///< two independent methods agree; false: no verdict may depend on this result
  /// Difference between the methods.
  double self_error_m = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace voxtouch::reference
