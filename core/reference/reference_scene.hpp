#pragma once
/// A scene as the reference sees it: gap between tool and static objects at any pose, found without
/// any rendering code.
#include <memory>

#include "core/reference/gap.hpp"
#include "core/scene/scene.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::reference {

/// Reads the scene's mesh files itself. Queries are const and may run at once (but for move_to);
/// they allocate. Not for the loop.
///
/// A declared sphere: s = signed distance of its centre - radius, by the closed form of declared
/// primitives, checked against FCL's distance to the mesh; without primitives by FCL in two ways,
/// signs by winding number. `unique_face`: the push directions at the rim of the contact patch (and
/// off the face, which finds an opposite wall) average to that of its middle within 5 degrees.
///
/// Any other dynamic object: FCL's mesh-mesh distance while apart; in overlap the depth of its
/// deepest corner, a lower bound (`depth_exact` and `unique_face` false). FCL's penetration depths
/// are not used: they are those of single pairs of triangles.
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

  /// Puts moving objects to where they are `time_s` after the session's begin. Not concurrently
  /// with a query.
  void move_to(double time_s) noexcept;

  /// The gap with the tool at `pose_WT`. A pose that is not finite gives method kNone.
  GapResult gap(const Pose& pose_WT) const;

  /// Distance between the surfaces of tool and static objects [m], not above 0 where they meet.
  /// Without the cross-check of `gap`.
  double apart_m(const Pose& pose_WT) const;

  /// Largest difference between declared primitives and meshes that a gap may carry: the dynamic
  /// object's plus the largest of the static ones [m]. What a Judge wants to know.
  double chord_error_m() const noexcept;

  /// The point of the static surface that is nearest to `x`, which lies outside.
  Vec3 nearest(const Vec3& x) const;

  /// No point of the dynamic object is farther from the tool's origin [m].
  double tool_reach_m() const noexcept;

  /// False where a static mesh is open or inconsistent: then nothing that hangs on being inside is
  /// judged.
  bool inside_known() const noexcept;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace voxtouch::reference
