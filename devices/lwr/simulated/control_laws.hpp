#pragma once
/// The controller's laws: from a set point and a state to joint torques beyond gravity. Real-time safe.
#include "devices/lwr/simulated/arm_dynamics.hpp"

namespace voxtouch::lwr_sim {

/// What the arm shall do now.
struct Setpoint {
  lwr::LwrJoints position = lwr::LwrJoints::Zero();   ///< qFRI [rad]
  lwr::LwrJoints torque = lwr::LwrJoints::Zero();     ///< tauFRI [Nm]
  lwr::LwrJoints stiffness = lwr::LwrJoints::Zero();  ///< [Nm/rad]
  lwr::LwrJoints damping = lwr::LwrJoints::Zero();    ///< share of critical
};

/// Assumed throughout: the real controller's inner gains are not published.
struct LawParameters {
  double position_bandwidth_rad_s = 100.0;  ///< of position control, critically damped
  bool compensates_coriolis = true;  ///< f_dyn: the model's velocity terms are added to the torque
  bool task_frame_is_tool = true;    ///< $STIFFNESS.TASKFRAME: the tool's axes; otherwise the base's
};

/// M (w^2 (q_d - q) - 2 w q') + c: computed torque.
lwr::LwrJoints position_law(const LawParameters& p, const ArmDynamics::Terms& terms, const lwr::LwrJoints& q,
                       const lwr::LwrJoints& rate, const lwr::LwrJoints& wanted) noexcept;

/// Axes of the task frame, in the base.
inline Mat3 task_axes(const LawParameters& p, const ArmDynamics::Terms& terms) noexcept {
  return p.task_frame_is_tool ? terms.tool.orientation.toRotationMatrix() : Mat3(Mat3::Identity());
}
/// The Jacobian with its rows along `axes`.
lwr::LwrJacobian in_axes(const Mat3& axes, const lwr::LwrJacobian& jacobian) noexcept;

/// Impedance of the joints without the overlaid torque: K (q_d - q) - D q'. Gains change slowly, so the damping matrix is made once a
/// tick (`prepare`) and the torque at each step (`torque`).
class Impedance {
 public:
  explicit Impedance(const LawParameters& parameters = {}) noexcept : parameters_(parameters) {}

  /// The damping matrix for the gains of `wanted` in this posture. Real-time safe.
  void prepare(const ArmDynamics::Terms& terms, const Setpoint& wanted) noexcept;
  /// Torques [Nm] towards `wanted` at `q` [rad] and `rate` [rad/s], with the damping prepared last. Real-time safe.
  lwr::LwrJoints torque(const ArmDynamics::Terms& terms, const lwr::LwrJoints& q, const lwr::LwrJoints& rate,
                   const Setpoint& wanted) const noexcept;

 private:
  LawParameters parameters_;
  LwrMatrix damping_ = LwrMatrix::Zero();
};

/// The force and torque at the tool that `torque` amounts to: Lambda J M^-1 torque (Khatib's dynamically consistent inverse).
Wrench tool_wrench(const ArmDynamics::Terms& terms, const lwr::LwrJoints& torque) noexcept;

}  // namespace voxtouch::lwr_sim
