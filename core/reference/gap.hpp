#pragma once
/// What the reference says about one pose of the tool.
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/types/geometry.hpp"

namespace voxtouch::reference {

/// [rad]
inline double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// How a gap was found, from the best known to the least.
enum class GapMethod : std::uint8_t {
  kNone,         ///< the pose was not finite; nothing is known
  kClosedForm,   ///< sphere against declared primitives, by their closed forms
  kSphereMesh,   ///< sphere against triangles: FCL distance of the centre, sign by the winding
                 ///< number
  kMeshMesh,     ///< two meshes, apart: FCL distance
  kVertexDepth,  ///< two meshes that overlap: depth of the deepest vertex, a lower bound
};

/// Signed distance between the dynamic and the static object and what belongs to it. World frame,
/// metres.
struct GapResult {
  /// Signed distance s: > 0 apart; < 0 minus the depth. Exact up to the chord error, save where
  /// `depth_exact` is false.
  double gap_m = std::numeric_limits<double>::quiet_NaN();
  /// Depth below the static surface that some point of the dynamic object's surface is known to
  /// have; 0 without overlap. At most -gap_m; less where the static object is thinner than the
  /// sphere has sunk. A lower bound, so "some shell point must collide" can be proved from it.
  double inside_depth_m = 0.0;
  /// Depth that all of the sphere's cap within sqrt(3) e of its deepest point has at least (seen at
  /// the pole and at six points of the rim); 0 where some of it is outside, and for meshes. An
  /// exact shell has a point in every such cap.
  double cap_inside_depth_m = 0.0;
  Vec3 nearest_static = Vec3::Zero();   ///< on the static surface
  Vec3 nearest_dynamic = Vec3::Zero();  ///< on the dynamic surface
  Vec3 direction =
      Vec3::Zero();  ///< unit; the way the static object pushes the dynamic one. Zero if unknown
  double sphere_radius_m =
      0.0;  ///< radius of the dynamic sphere; 0 where the dynamic object is a mesh
  /// `direction` stands for the whole contact patch, not for one of several faces. False where no
  /// contact is possible.
  bool unique_face = false;
  bool depth_exact = false;  ///< depth and gap are the same thing here: one face, thick enough
  bool inside_known =
      true;  ///< false: the static mesh is open or inconsistent; it has no inside to be in
  GapMethod method = GapMethod::kNone;
  bool self_check =
      false;  ///< two independent ways gave the same distance; false: trust no verdict on this
  double self_error_m = std::numeric_limits<double>::quiet_NaN();  ///< by how much they differ
};

}  // namespace voxtouch::reference
