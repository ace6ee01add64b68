#include "core/scene/contact_range.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace voxtouch {
namespace {

/// Sums and an eigenvalue are rounded: an upper bound is brought above both.
constexpr double kRoundingUp = 1.0 + 1e-12;

}  // namespace

ContactStiffness contact_stiffness(const Pointshell& shell, double stiffness_n_per_m) {
  ContactStiffness out;
  if (shell.size() == 0) return out;
  double longest_squared = 0.0;
  Mat3 inertia = Mat3::Zero();
  for (std::size_t p = 0; p < shell.size(); ++p) {
    const Vec3 arm = shell.point(p);
    longest_squared = std::max(longest_squared, arm.squaredNorm());
    inertia += arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(inertia, Eigen::EigenvaluesOnly);
  out.translation = {stiffness_n_per_m, stiffness_n_per_m * static_cast<double>(shell.size())};
  out.rotation.one_point = stiffness_n_per_m * longest_squared * kRoundingUp;
  out.rotation.all_points = std::max(out.rotation.one_point, stiffness_n_per_m * solver.eigenvalues()[2] * kRoundingUp);
  return out;
}

}  // namespace voxtouch
