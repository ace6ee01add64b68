#pragma once
/// Control laws of the controller: from a set point and a state to joint torques in addition to
/// gravity. Real-time safe.
#include "devices/arm/simulated/arm_dynamics.hpp"

namespace voxtouch::arm_sim {

/// Present set point of the arm.
struct Setpoint {
  arm::Joints position = arm::Joints::Zero();   ///< qFRI [rad]
  arm::Joints torque = arm::Joints::Zero();     ///< tauFRI [Nm]
  arm::Joints stiffness = arm::Joints::Zero();  ///< [Nm/rad]
  arm::Joints damping = arm::Joints::Zero();    ///< fraction of critical
};

/// All values are assumed: the inner gains of the real controller are not published.
struct LawParameters {
  double position_bandwidth_rad_s = 100.0;  ///< of position control, critically damped
  /// f_dyn: the velocity terms of the model are added to the torque.
  bool compensates_coriolis = true;
  bool task_frame_is_tool = true;  ///< $STIFFNESS.TASKFRAME: the tool's axes; otherwise the base's
};

/// M (w^2 (q_d - q) - 2 w q') + c: computed torque.
arm::Joints position_law(const LawParameters& p, const ArmDynamics::Terms& terms,
                         const arm::Joints& q, const arm::Joints& rate,
                         const arm::Joints& requested) noexcept;

/// Axes of the task frame, in the base.
inline Mat3 task_axes(const LawParameters& p, const ArmDynamics::Terms& terms) noexcept {
  return p.task_frame_is_tool ? terms.tool.orientation.toRotationMatrix() : Mat3(Mat3::Identity());
}
/// The Jacobian with its rows along `axes`.
arm::Jacobian in_axes(const Mat3& axes, const arm::Jacobian& jacobian) noexcept;

/// Joint impedance without the additional torque: K (q_d - q) - D q'. Gains change slowly, so the
/// damping matrix is computed once per tick (`prepare`) and the torque at each step (`torque`).
class Impedance {
 public:
  explicit Impedance(const LawParameters& parameters = {}) noexcept : parameters_(parameters) {}

  /// The damping matrix for the gains of `requested` in this posture. Real-time safe.
  void prepare(const ArmDynamics::Terms& terms, const Setpoint& requested) noexcept;
  /// Torques [Nm] towards `requested` at `q` [rad] and `rate` [rad/s], with the damping prepared
  /// last. Real-time safe.
  arm::Joints torque(const ArmDynamics::Terms& terms, const arm::Joints& q, const arm::Joints& rate,
                     const Setpoint& requested) const noexcept;

 private:
  LawParameters parameters_;
  JointMatrix damping_ = JointMatrix::Zero();
};

/// Force and torque at the tool equivalent to `torque`: Lambda J M^-1 torque (Khatib's dynamically
/// consistent inverse).
Wrench tool_wrench(const ArmDynamics::Terms& terms, const arm::Joints& torque) noexcept;

}  // namespace voxtouch::arm_sim
