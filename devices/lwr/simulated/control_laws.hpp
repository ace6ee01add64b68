#pragma once
/// The controller's laws: from a set point and a state to joint torques beyond gravity. Real-time safe.
#include "devices/lwr/simulated/arm_dynamics.hpp"

namespace voxtouch::lwr_sim {

/// What the arm shall do now. Poses in the base; wrench and Cartesian gains in the task frame's axes, about the tool's origin.
struct Setpoint {
  LwrJoints position = LwrJoints::Zero();   ///< qFRI; the posture of the null space in Cartesian impedance [rad]
  Pose pose;                                ///< xFRI
  LwrJoints torque = LwrJoints::Zero();     ///< tauFRI [Nm]
  Vec6 wrench = Vec6::Zero();               ///< FFRI [N, Nm]
  LwrJoints stiffness = LwrJoints::Zero();  ///< [Nm/rad]
  LwrJoints damping = LwrJoints::Zero();    ///< share of critical
  Vec6 cart_stiffness = Vec6::Zero();       ///< [N/m, Nm/rad]
  Vec6 cart_damping = Vec6::Zero();         ///< share of critical
};

/// Assumed throughout: the real controller's inner gains are not published.
struct LawParameters {
  double position_bandwidth_rad_s = 100.0;  ///< of position control, critically damped
  double null_stiffness_nm_per_rad = 20.0;  ///< towards the posture, beside the tool's motion
  double null_damping = 0.7;
  bool compensates_coriolis = true;  ///< f_dyn: the model's velocity terms are added to the torque
  bool task_frame_is_tool = true;    ///< $STIFFNESS.TASKFRAME: the tool's axes; otherwise the base's
};

/// M (w^2 (q_d - q) - 2 w q') + c: computed torque.
LwrJoints position_law(const LawParameters& p, const ArmDynamics::Terms& terms, const LwrJoints& q,
                       const LwrJoints& rate, const LwrJoints& wanted) noexcept;

/// Axes of the task frame, in the base.
inline Mat3 task_axes(const LawParameters& p, const ArmDynamics::Terms& terms) noexcept {
  return p.task_frame_is_tool ? terms.tool.orientation.toRotationMatrix() : Mat3(Mat3::Identity());
}
/// The Jacobian with its rows along `axes`.
LwrJacobian in_axes(const Mat3& axes, const LwrJacobian& jacobian) noexcept;

/// Impedance without the overlaid torque: K (q_d - q) - D q', or J^T (K (x_d - x) - D x') with a posture in the null space.
/// Gains change slowly, so the damping matrices are made once a tick (`prepare`) and the torque at each step (`torque`).
class Impedance {
 public:
  explicit Impedance(const LawParameters& parameters = {}) noexcept : parameters_(parameters) {}

  void prepare_joint(const ArmDynamics::Terms& terms, const Setpoint& wanted) noexcept;
  void prepare_cartesian(const ArmDynamics::Terms& terms, const Setpoint& wanted) noexcept;
  LwrJoints torque(const ArmDynamics::Terms& terms, const LwrJoints& q, const LwrJoints& rate,
                   const Setpoint& wanted) const noexcept;

 private:
  LawParameters parameters_;
  bool cartesian_ = false;
  LwrMatrix joint_damping_ = LwrMatrix::Zero();
  Mat6 cart_damping_ = Mat6::Zero();                                              // in the task frame
  Eigen::Matrix<double, 7, 6> consistent_ = Eigen::Matrix<double, 7, 6>::Zero();  // M^-1 J^T Lambda
};

/// The force and torque at the tool that `torque` amounts to: Lambda J M^-1 torque (Khatib's dynamically consistent inverse).
Wrench tool_wrench(const ArmDynamics::Terms& terms, const LwrJoints& torque) noexcept;

}  // namespace voxtouch::lwr_sim
