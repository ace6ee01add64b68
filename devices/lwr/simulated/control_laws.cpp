#include "devices/lwr/simulated/control_laws.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace voxtouch::lwr_sim {
namespace {

constexpr double kRegular = 1e-6;  // [1/kg] keeps Lambda finite where the arm is stretched

/// Double diagonalisation: D = 2 L sqrt(L^-1 K L^-T) L^T with M = L L^T damps every mode of (M, K) critically; shares of it enter
/// by their roots from both sides, so that D stays positive semidefinite (Albu-Schaeffer et al. on damping design).
template <int N>
Eigen::Matrix<double, N, N> damping(const Eigen::Matrix<double, N, N>& mass,
                                    const Eigen::Matrix<double, N, 1>& stiffness,
                                    const Eigen::Matrix<double, N, 1>& share) noexcept {
  using Square = Eigen::Matrix<double, N, N>;
  if (stiffness.isZero(0.0) || share.isZero(0.0)) return Square::Zero();
  const Square lower = mass.llt().matrixL();
  const Square root = stiffness.cwiseSqrt().asDiagonal();
  const Square half = lower.template triangularView<Eigen::Lower>().solve(root);
  const Eigen::SelfAdjointEigenSolver<Square> modes(half * half.transpose());
  const Square middle = modes.eigenvectors() * modes.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
                        modes.eigenvectors().transpose();
  const Square scaled = share.cwiseSqrt().asDiagonal() * lower;
  return 2.0 * scaled * middle * scaled.transpose();
}

Mat6 tool_inertia(const LwrMatrix& mass, const LwrJacobian& jacobian, Eigen::Matrix<double, 7, 6>& mobility) noexcept {
  mobility = mass.llt().solve(jacobian.transpose());
  const Mat6 inverse = jacobian * mobility + kRegular * Mat6::Identity();
  return inverse.llt().solve(Mat6::Identity());
}

/// From the tool's pose to `wanted`: translation, and 2 sin(angle / 2) along the axis.
Vec6 way_to(const Pose& wanted, const Pose& tool) noexcept {
  const Quat turn = wanted.orientation * tool.orientation.conjugate();
  Vec6 way;
  way << wanted.position - tool.position, (turn.w() < 0.0 ? -2.0 : 2.0) * turn.vec();
  return way;
}

}  // namespace

LwrJacobian in_axes(const Mat3& axes, const LwrJacobian& jacobian) noexcept {
  LwrJacobian out;
  out.topRows<3>() = axes.transpose() * jacobian.topRows<3>();
  out.bottomRows<3>() = axes.transpose() * jacobian.bottomRows<3>();
  return out;
}

LwrJoints position_law(const LawParameters& p, const ArmDynamics::Terms& terms, const LwrJoints& q,
                       const LwrJoints& rate, const LwrJoints& wanted) noexcept {
  const double w = p.position_bandwidth_rad_s;
  return terms.mass * (w * w * (wanted - q) - 2.0 * w * rate) + terms.coriolis;
}

void Impedance::prepare_joint(const ArmDynamics::Terms& terms, const Setpoint& wanted) noexcept {
  cartesian_ = false;
  joint_damping_ = damping<7>(terms.mass, wanted.stiffness, wanted.damping);
}

void Impedance::prepare_cartesian(const ArmDynamics::Terms& terms, const Setpoint& wanted) noexcept {
  cartesian_ = true;
  Eigen::Matrix<double, 7, 6> mobility;
  const Mat6 inertia = tool_inertia(terms.mass, in_axes(task_axes(parameters_, terms), terms.jacobian), mobility);
  cart_damping_ = damping<6>(inertia, wanted.cart_stiffness, wanted.cart_damping);
  consistent_ = mobility * inertia;
  joint_damping_ = damping<7>(terms.mass, LwrJoints::Constant(parameters_.null_stiffness_nm_per_rad),
                              LwrJoints::Constant(parameters_.null_damping));
}

LwrJoints Impedance::torque(const ArmDynamics::Terms& terms, const LwrJoints& q, const LwrJoints& rate,
                            const Setpoint& wanted) const noexcept {
  LwrJoints torque = parameters_.compensates_coriolis ? terms.coriolis : LwrJoints(LwrJoints::Zero());
  if (!cartesian_) {
    torque += wanted.stiffness.cwiseProduct(wanted.position - q) - joint_damping_ * rate;
    return torque;
  }
  const Mat3 axes = task_axes(parameters_, terms);
  const LwrJacobian jacobian = in_axes(axes, terms.jacobian);
  const Vec6 way = way_to(wanted.pose, terms.tool);
  Vec6 way_in_axes;
  way_in_axes << axes.transpose() * way.head<3>(), axes.transpose() * way.tail<3>();
  const Vec6 force = wanted.cart_stiffness.cwiseProduct(way_in_axes) - cart_damping_ * (jacobian * rate);
  const LwrJoints posture = parameters_.null_stiffness_nm_per_rad * (wanted.position - q) - joint_damping_ * rate;
  torque += jacobian.transpose() * (force - consistent_.transpose() * posture) + posture;
  return torque;
}

Wrench tool_wrench(const ArmDynamics::Terms& terms, const LwrJoints& torque) noexcept {
  Eigen::Matrix<double, 7, 6> mobility;
  const Mat6 inertia = tool_inertia(terms.mass, terms.jacobian, mobility);
  const Vec6 wrench = inertia * (mobility.transpose() * torque);
  return {wrench.head<3>(), wrench.tail<3>()};
}

}  // namespace voxtouch::lwr_sim
