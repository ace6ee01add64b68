#pragma once
/// Rotation of the tool for a device that senses rotation and returns no torque.
#include "core/types/geometry.hpp"

namespace voxtouch::rendering {

/// Limits rotations that would store energy in the contact. A rotation against the contact's torque
/// t stores energy for which the operator does no work. When the contact force then moves the tool
/// out, this energy is generated from nothing. With the potential V(x, q) of the contact,
///
///     dV = -f . dx - t . dq
///
/// the forces alone are passive if no rotation increases V: t . dq >= 0. The tool therefore follows
/// the rotation of the hand except for the part about the contact's torque that opposes it, which
/// is latched. The remainder within 45 degrees of that axis is latched too, because the axis is not
/// known exactly. The tool catches up at kCatchUpPerS times the remaining angle if the contact
/// permits it, so that it causes no impact. Without contact it is bit-identical to the hand's
/// rotation.
///
/// The torque is that of the previous sample, so a rotation of one sample into a new contact is not
/// latched. Real-time safe.
class LatchedRotation {
 public:
  static constexpr double kCatchUpPerS = 2.0;
  /// Rotations of the hand between two samples beyond this are jumps [rad]: the tool takes the
  /// rotation of the hand at once.
  static constexpr double kJumpRad = 0.5;

  /// The tool's rotation for that of the hand, T in W, `dt_s` [s] after the last sample.
  const Quat& follow(const Quat& hand, double dt_s) noexcept;
  /// Sets the contact's torque on the tool, about its origin, W axes.
  void set_torque(const Vec3& torque) noexcept { torque_ = torque; }
  void reset() noexcept { known_ = false, torque_.setZero(); }

 private:
  Quat hand_ = Quat::Identity(), tool_ = Quat::Identity();
  Vec3 torque_ = Vec3::Zero();
  bool known_ = false;
};

}  // namespace voxtouch::rendering
