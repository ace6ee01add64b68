#pragma once
/// How fast joint torques may change, kept on the way to the wire: the robot stops itself where
/// they jump.
#include "devices/arm/joints.hpp"

namespace voxtouch::fr3 {

/// The wrench on its way to the requested one: a straight line, so that a force that begins,
/// changes or ends keeps to the lengths of both ends, along which every joint's torque moves by at
/// most `step_nm` a command. Real-time safe.
class TorqueRamp {
 public:
  /// `step_nm`: per command. `most_nm`: of each joint, whatever is asked for.
  TorqueRamp(double step_nm, const arm::Joints& most_nm) noexcept
      : step_nm_(step_nm),
        most_nm_(most_nm) {}

  /// What the robot reports as received last: a command that was lost on the way is not counted as
  /// given. What it says outside of the last two commands is not believed, nor that it has received
  /// nothing for over 20 commands; without a number the last one counts.
  void acknowledge(const arm::Joints& tau_d) noexcept;
  /// The joint torques of the next command towards `requested` (base axes, at the tool of
  /// `jacobian`) and `posture` [Nm], torques that move the joints without the tool.
  const arm::Joints& next(const arm::Jacobian& jacobian, const Wrench& requested,
                          const arm::Joints& posture) noexcept;
  /// Nothing pushes any more: the robot has ended the motion by itself.
  void forget() noexcept;

  /// The last command was zero, and nothing is under way.
  bool at_rest() const noexcept {
    return sent_.isZero(0.0) && wrench_.isZero(0.0) && posture_.isZero(0.0);
  }

 private:
  double step_nm_;
  arm::Joints most_nm_;
  Vec6 wrench_ = Vec6::Zero();
  arm::Joints posture_ = arm::Joints::Zero();
  int unheard_ = 0;
  arm::Joints sent_ = arm::Joints::Zero(),
              given_ = arm::Joints::Zero();  // given_: the one before, or the last if it arrived
};

}  // namespace voxtouch::fr3
