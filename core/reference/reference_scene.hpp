#pragma once
/// The scene of the reference: gap between tool and static objects at any pose, computed without
/// any rendering code.
#include <memory>

#include "core/reference/gap.hpp"
#include "core/scene/scene.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::reference {

/// Reads the scene's mesh files itself. Queries are const and may run concurrently, except with
/// move_to; they allocate. Not for the loop.
///
/// A declared sphere: s is the signed distance of its centre minus its radius. With declared
/// primitives it follows from their closed forms, checked against FCL's distance to the mesh.
/// Without primitives FCL computes it by two methods, with signs from the winding number.
/// `unique_face`: the mean force direction at the rim of the contact patch is within 5 degrees of
/// that at its centre. Directions off the face are included, to find an opposite wall.
///
/// Any other dynamic object: FCL's mesh-mesh distance while separate. In overlap, the depth of its
/// deepest corner, a lower bound (`depth_exact` and `unique_face` are false). FCL's penetration
/// depths are not used, since they refer to single pairs of triangles.
///
/// Several static meshes count as their union.
class ReferenceScene {
 public:
  /// Throws std::runtime_error naming the file if a mesh cannot be read, or if the scene has no
  /// static mesh or voxel size.
  explicit ReferenceScene(const scene::Scene& scene);
  ~ReferenceScene();
  ReferenceScene(ReferenceScene&&) noexcept;
  ReferenceScene& operator=(ReferenceScene&&) noexcept;

  /// Sets moving objects to their positions `time_s` after the start of the session. Not
  /// concurrently with a query.
  void move_to(double time_s) noexcept;

  /// The gap with the tool at `pose_WT`. A pose that is not finite gives method kNone.
  GapResult gap(const Pose& pose_WT) const;

  /// Distance between the surfaces of tool and static objects [m], at most 0 if they meet. Without
  /// the cross-check of `gap`.
  double apart_m(const Pose& pose_WT) const;

  /// Largest difference between declared primitives and meshes in a gap: that of the dynamic object
  /// plus the largest of the static ones [m]. An input of ContactValidator.
  double chord_error_m() const noexcept;

  /// The point of the static surface nearest to `x`, which must lie outside.
  Vec3 nearest(const Vec3& x) const;

  /// Largest distance of a point of the dynamic object from the tool's origin [m].
  double tool_reach_m() const noexcept;

  /// False if a static mesh is open or inconsistent: no verdict then depends on the interior.
  bool inside_known() const noexcept;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace voxtouch::reference
