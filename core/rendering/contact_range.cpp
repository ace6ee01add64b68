#include "core/rendering/contact_range.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace voxtouch::rendering {
namespace {

/// Sums and an eigenvalue are rounded; the factor keeps the result an upper bound.
constexpr double kRoundingUp = 1.0 + 1e-12;

}  // namespace

StiffnessBounds contact_stiffness(const pointshell::Pointshell& shell,
                                  const contact::ContactParameters& parameters, double steepest) {
  StiffnessBounds out;
  if (shell.size() == 0)
    return out;
  const double stiffness = parameters.stiffness * steepest;
  double heaviest = 0.0, weights = 0.0, largest_moment = 0.0;
  Mat3 inertia = Mat3::Zero();
  for (std::size_t p = 0; p < shell.size(); ++p) {
    const Vec3 arm = shell.point(p);
    const double weight =
        parameters.weights == contact::PointWeights::kArea ? shell.area_m2[p] : 1.0;
    heaviest = std::max(heaviest, weight);
    weights += weight;
    largest_moment = std::max(largest_moment, weight * arm.squaredNorm());
    inertia += weight * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(inertia, Eigen::EigenvaluesOnly);
  out.translation = {stiffness * heaviest, stiffness * weights};
  out.rotation.one_point = stiffness * largest_moment * kRoundingUp;
  out.rotation.all_points =
      std::max(out.rotation.one_point, stiffness * solver.eigenvalues()[2] * kRoundingUp);
  return out;
}

}  // namespace voxtouch::rendering
