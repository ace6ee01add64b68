#include "devices/arm/simulated/control_laws.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace voxtouch::arm_sim {
namespace {

constexpr double kRegular = 1e-6;  // [1/kg] keeps Lambda finite for a stretched arm

/// Double diagonalisation: D = 2 L sqrt(L^-1 K L^-T) L^T with M = L L^T damps every mode of (M, K)
/// critically. Fractions of it enter by their roots from both sides, so that D stays positive
/// semidefinite (Albu-Schaeffer et al. on damping design).
JointMatrix damping(const JointMatrix& mass, const arm::Joints& stiffness,
                    const arm::Joints& fraction) noexcept {
  if (stiffness.isZero(0.0) || fraction.isZero(0.0))
    return JointMatrix::Zero();
  const JointMatrix lower = mass.llt().matrixL();
  const JointMatrix root = stiffness.cwiseSqrt().asDiagonal();
  const JointMatrix half = lower.triangularView<Eigen::Lower>().solve(root);
  const Eigen::SelfAdjointEigenSolver<JointMatrix> modes(half * half.transpose());
  const JointMatrix middle = modes.eigenvectors() *
                             modes.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
                             modes.eigenvectors().transpose();
  const JointMatrix scaled = fraction.cwiseSqrt().asDiagonal() * lower;
  return 2.0 * scaled * middle * scaled.transpose();
}

}  // namespace

arm::Jacobian in_axes(const Mat3& axes, const arm::Jacobian& jacobian) noexcept {
  arm::Jacobian out;
  out.topRows<3>() = axes.transpose() * jacobian.topRows<3>();
  out.bottomRows<3>() = axes.transpose() * jacobian.bottomRows<3>();
  return out;
}

arm::Joints position_law(const LawParameters& p, const ArmDynamics::Terms& terms,
                         const arm::Joints& q, const arm::Joints& rate,
                         const arm::Joints& requested) noexcept {
  const double w = p.position_bandwidth_rad_s;
  return terms.mass * (w * w * (requested - q) - 2.0 * w * rate) + terms.coriolis;
}

void Impedance::prepare(const ArmDynamics::Terms& terms, const Setpoint& requested) noexcept {
  damping_ = damping(terms.mass, requested.stiffness, requested.damping);
}

arm::Joints Impedance::torque(const ArmDynamics::Terms& terms, const arm::Joints& q,
                              const arm::Joints& rate, const Setpoint& requested) const noexcept {
  arm::Joints torque =
      parameters_.compensates_coriolis ? terms.coriolis : arm::Joints(arm::Joints::Zero());
  torque += requested.stiffness.cwiseProduct(requested.position - q) - damping_ * rate;
  return torque;
}

Wrench tool_wrench(const ArmDynamics::Terms& terms, const arm::Joints& torque) noexcept {
  const Eigen::Matrix<double, 7, 6> mobility = terms.mass.llt().solve(terms.jacobian.transpose());
  const Mat6 inverse = terms.jacobian * mobility + kRegular * Mat6::Identity();
  const Mat6 inertia = inverse.llt().solve(Mat6::Identity());
  const Vec6 wrench = inertia * (mobility.transpose() * torque);
  return {wrench.head<3>(), wrench.tail<3>()};
}

}  // namespace voxtouch::arm_sim
