#pragma once
/// The rotation of a tool whose device senses rotation and returns no torque.
#include "core/types/geometry.hpp"

namespace voxtouch::rendering {

/// A turn against the contact's torque t stores energy in the contact that no torque takes from the
/// hand; pressed out again along the force it is energy from nothing. With the contact's potential
/// V(x, q),
///
///     dV = -f . dx - t . dq,
///
/// the forces alone are passive if no turn makes V larger: t . dq >= 0. So the tool follows the
/// hand's rotation but for the part about the contact's torque that is against it, which is held,
/// and what is left within 45 degrees of that axis with it, for the axis is never quite known. It
/// catches up where the contact lets it, by kCatchUpPerS of the angle that is left, so that it does
/// not strike. Without contact it is the hand's, bit for bit.
///
/// The torque is that of the sample before: a turn of one sample against a contact that it reaches
/// is not held. Real-time safe.
class LatchedRotation {
 public:
  static constexpr double kCatchUpPerS = 2.0;
  /// Turns of the hand from one sample to the next that are no motion [rad]: the tool is turned as
  /// the hand at once.
  static constexpr double kJumpRad = 0.5;

  /// The tool's rotation for the hand's, T in W, `dt_s` after the last.
  const Quat& follow(const Quat& hand, double dt_s) noexcept;
  /// The contact's torque on the tool there, about its origin, W axes.
  void see(const Vec3& torque) noexcept { torque_ = torque; }
  void reset() noexcept { known_ = false, torque_.setZero(); }

 private:
  Quat hand_ = Quat::Identity(), tool_ = Quat::Identity();
  Vec3 torque_ = Vec3::Zero();
  bool known_ = false;
};

}  // namespace voxtouch::rendering
