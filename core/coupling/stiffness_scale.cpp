#include "core/coupling/stiffness_scale.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace voxtouch::coupling {
namespace {

/// Inverse of a cap. The upper limit prevents an overflow for a cap close to zero.
double per(double cap) noexcept { return std::min(1.0 / cap, 1e100); }

/// Fixed size: Eigen keeps it on the stack, and its iteration is bounded.
template <class Matrix>
double largest(const Matrix& matrix) noexcept {
  const Matrix symmetric = 0.5 * (matrix + matrix.transpose());
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(symmetric, Eigen::EigenvaluesOnly);
  // The Frobenius norm is an upper bound of the largest eigenvalue; used if the iteration does not
  // converge.
  const double value =
      solver.info() == Eigen::Success ? solver.eigenvalues().maxCoeff() : symmetric.norm();
  return std::max(value, 0.0);
}

}  // namespace

double largest_eigenvalue(const Mat3& matrix) noexcept { return largest(matrix); }
double largest_eigenvalue(const Mat6& matrix) noexcept { return largest(matrix); }

double cap_scale(const Mat6& stiffness, double bound, double per_cap_t, double per_cap_r) noexcept {
  if (!(per_cap_t > 0.0) && !(per_cap_r > 0.0))
    return 1.0;
  double excess = 0.0;  // stiffness in units of its caps
  if (stiffness.isZero(0.0)) {
    excess = bound * per_cap_t;
  } else if (per_cap_r > 0.0) {
    const double t = std::sqrt(per_cap_t), r = std::sqrt(per_cap_r);
    const Vec6 n = (Vec6() << t, t, t, r, r, r).finished();
    excess = largest_eigenvalue(Mat6(n.asDiagonal() * stiffness * n.asDiagonal()));
  } else {
    excess = per_cap_t * largest_eigenvalue(Mat3(stiffness.topLeftCorner<3, 3>()));
  }
  if (!std::isfinite(excess))
    return 0.0;
  return excess > 1.0 ? 1.0 / excess : 1.0;
}

StiffnessScale::StiffnessScale(const CouplingSpec& spec) noexcept
    : per_cap_t_(per(spec.stiffness_cap_n_per_m)),
      per_cap_r_(per(spec.stiffness_cap_nm_per_rad)) {}

void StiffnessScale::redesign(const CouplingSpec& spec) noexcept {
  per_cap_t_ = per(spec.stiffness_cap_n_per_m), per_cap_r_ = per(spec.stiffness_cap_nm_per_rad);
  redesigned_ = true;
}

double StiffnessScale::step(const CouplingInput& input, double dt_s) noexcept {
  const double allowed =
      cap_scale(input.contact_stiffness, input.contact_stiffness_n_per_m, per_cap_t_, per_cap_r_);
  if (redesigned_) {
    over_ = Ramp(allowed > 0.0 ? std::clamp(scale_ / allowed, 0.0, 1e12) : 1.0);
    over_.head_for(1.0, kDefaultRampS);
    redesigned_ = false;
  }
  return scale_ = std::min(allowed * over_.advance(dt_s), 1.0);
}

}  // namespace voxtouch::coupling
