#pragma once
/// Limits the rate of the commanded joint torques, because the robot stops itself at a jump.
#include "devices/arm/joints.hpp"

namespace voxtouch::fr3 {

/// Moves the wrench to the requested one along a straight line, along which the torque of every
/// joint changes by at most `step_nm` per command. A force that begins, changes or ends thus stays
/// between the values at both ends. Real-time safe.
class TorqueRamp {
 public:
  /// `step_nm`: per command. `most_nm`: limit of each joint for any request.
  TorqueRamp(double step_nm, const arm::Joints& most_nm) noexcept
      : step_nm_(step_nm),
        most_nm_(most_nm) {}

  /// Takes the torque that the robot reports as last received, so that a lost command does not
  /// count as executed. Each joint of the report is limited to the range between the last two
  /// commands. The last command counts as received if the report is not finite, or after more than
  /// 20 commands that did not arrive.
  void acknowledge(const arm::Joints& tau_d) noexcept;
  /// The joint torques of the next command towards `requested` (base axes, at the tool of
  /// `jacobian`) and `posture` [Nm]. `posture` moves the joints but not the tool.
  const arm::Joints& next(const arm::Jacobian& jacobian, const Wrench& requested,
                          const arm::Joints& posture) noexcept;
  /// The robot has ended the motion itself: no force acts.
  void forget() noexcept;

  /// Whether the last command was zero and no ramp is in progress.
  bool at_rest() const noexcept {
    return sent_.isZero(0.0) && wrench_.isZero(0.0) && posture_.isZero(0.0);
  }

 private:
  double step_nm_;
  arm::Joints most_nm_;
  Vec6 wrench_ = Vec6::Zero();
  arm::Joints posture_ = arm::Joints::Zero();
  int unheard_ = 0;
  // given_: the torque that counts as received.
  arm::Joints sent_ = arm::Joints::Zero(), given_ = arm::Joints::Zero();
};

}  // namespace voxtouch::fr3
