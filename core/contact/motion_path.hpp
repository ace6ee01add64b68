#pragma once
/// The straight way between two poses of the tool, and whether a contact stands against it.
#include "core/types/geometry.hpp"

namespace voxtouch::contact {

/// Translation at constant speed with a turn at constant speed about one axis through the tool's origin, the shorter way round.
/// Real-time safe.
class MotionPath {
 public:
  /// Both orientations of unit norm.
  MotionPath(const Pose& from, const Pose& to) noexcept;

  /// At the share `t` of the way; 0 and 1 give the two poses to the bit.
  Pose at(double t) const noexcept;
  /// Bound of the way that any point within `reach_m` of the tool's origin goes [m].
  double length_m(double reach_m) const noexcept { return shift_.norm() + turn_.norm() * reach_m; }
  /// Into how many pieces of at most `step_m` it is cut; at least 1, at most `most` + 1 (which says: more than `most`).
  int steps(double reach_m, double step_m, int most) const noexcept;

  /// Of a wrench over the whole way: below zero it stands against the motion, above it pushes on.
  /// \returns its work over the most that a wrench of its size could do, in [-1, 1]; 0 where there is no wrench.
  double share(const Wrench& wrench) const noexcept;
  /// Its work [J].
  double work_j(const Wrench& wrench) const noexcept { return wrench.force.dot(shift_) + wrench.torque.dot(turn_); }

 private:
  Pose from_, to_;
  Vec3 shift_;  ///< [m], W
  Vec3 turn_;   ///< rotation vector [rad], W
};

}  // namespace voxtouch::contact
