#include "core/rendering/contact_range.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace voxtouch::rendering {
namespace {

/// Sums and an eigenvalue are rounded: an upper bound is brought above both.
constexpr double kRoundingUp = 1.0 + 1e-12;

/// What moving weights to whoever stands for a point adds to any eigenvalue of the inertia.
double moved_inertia(const pointshell::Pointshell& shell, const pointshell::ShellLevels& levels,
                     std::size_t p) {
  const Vec3 at = shell.point(p);
  double most = 0.0;
  for (std::size_t q = p; levels.stands_in[q] != q;) {
    q = levels.stands_in[q];
    most = std::max(most, (shell.point(q) - at).norm() * (shell.point(q).norm() + at.norm()));
  }
  return most;
}

}  // namespace

StiffnessBounds contact_stiffness(const pointshell::Pointshell& shell,
                                  const contact::ContactParameters& parameters, double steepest,
                                  const pointshell::ShellLevels& levels) {
  StiffnessBounds out;
  if (shell.size() == 0)
    return out;
  const double stiffness = parameters.stiffness * steepest;
  double heaviest = 0.0, weights = 0.0, largest_moment = 0.0, moved = 0.0;
  Mat3 inertia = Mat3::Zero();
  for (std::size_t p = 0; p < shell.size(); ++p) {
    const Vec3 arm = shell.point(p);
    const double weight =
        parameters.weights == contact::PointWeights::kArea ? shell.area_m2[p] : 1.0;
    heaviest = std::max(heaviest, weight);
    weights += weight;
    largest_moment = std::max(largest_moment, weight * arm.squaredNorm());
    inertia += weight * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
    if (!levels.empty())
      moved += weight * moved_inertia(shell, levels, p);
  }
  if (!levels.empty()) {
    const std::vector<double> ones(shell.size(), 1.0);
    const std::vector<double> coarsest =
        level_weights(levels,
                      parameters.weights == contact::PointWeights::kArea ? shell.area_m2 : ones)
            .front();
    for (std::size_t p = 0; p < coarsest.size(); ++p) {
      heaviest = std::max(heaviest, coarsest[p]);
      largest_moment = std::max(largest_moment, coarsest[p] * shell.point(p).squaredNorm());
    }
    // Points of finer levels weigh at most what those that stand for them weigh at the coarsest,
    // wherever they are.
    for (std::size_t p = coarsest.size(); p < shell.size(); ++p) {
      std::size_t whose = p;
      while (levels.stands_in[whose] != whose)
        whose = levels.stands_in[whose];
      largest_moment = std::max(largest_moment, coarsest[whose] * shell.point(p).squaredNorm());
    }
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(inertia, Eigen::EigenvaluesOnly);
  out.translation = {stiffness * heaviest, stiffness * weights};
  out.rotation.one_point = stiffness * largest_moment * kRoundingUp;
  out.rotation.all_points =
      std::max(out.rotation.one_point, stiffness * (solver.eigenvalues()[2] + moved) * kRoundingUp);
  return out;
}

}  // namespace voxtouch::rendering
