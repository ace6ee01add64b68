#include "effect_check.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace voxtouch::test {
namespace {

constexpr double kLever = 0.01;  // metres that a radian counts

Pose moved(const Pose& pose, int axis, double by) {
  Pose out = pose;
  if (axis < 3)
    out.position[axis] += by;
  else
    out.orientation = Quat(Eigen::AngleAxisd(by / kLever, Vec3::Unit(axis - 3))) * pose.orientation;
  return out;
}

Vec6 as_vector(const Wrench& w) {
  Vec6 v;
  v << w.force, w.torque / kLever;
  return v;
}

}  // namespace

effects::EffectSpec effect(
    std::string_view kind,
    std::initializer_list<std::pair<std::string_view, std::array<double, 3>>> values,
    const effects::Region& region) {
  effects::EffectSpec spec{.name = std::string(kind),
                           .kind = effects::find_effect_kind(kind),
                           .values = {},
                           .region = region};
  if (spec.kind == nullptr)
    throw std::invalid_argument(std::string(kind));
  spec.values = effects::EffectValues(spec.kind->parameters);
  for (const auto& [name, value] : values) {
    const auto found =
        std::find_if(spec.kind->parameters.begin(), spec.kind->parameters.end(),
                     [n = name](const effects::EffectParameter& p) { return p.name == n; });
    if (found == spec.kind->parameters.end())
      throw std::invalid_argument(std::string(name));
    spec.values.at(static_cast<std::size_t>(found - spec.kind->parameters.begin())) = value;
  }
  return spec;
}

Vec3 Random::direction() {
  for (;;) {
    const Vec3 v = vector(1.0);
    if (v.norm() > 0.1 && v.norm() < 1.0)
      return v.normalized();
  }
}

Quat Random::orientation() {
  return Quat(Eigen::AngleAxisd(number(0, std::numbers::pi), direction()));
}

effects::EffectForce Bench::at(const Pose& pose) noexcept {
  effects::EffectFrame frame;
  frame.tool = pose, frame.dt_s = 0.001;
  frame.proximity = proximity_, frame.tool_points = points_;
  return chain_.apply(frame);
}

void expect_force_of_potential(Bench& bench, const Pose& pose, double tolerance_n,
                               bool with_rotation, double step) {
  const Vec6 wrench = as_vector(bench.at(pose).wrench);
  for (int axis = 0; axis < (with_rotation ? 6 : 3); ++axis) {
    const double slope = (bench.at(moved(pose, axis, step)).potential_j -
                          bench.at(moved(pose, axis, -step)).potential_j) /
                         (2 * step);
    EXPECT_NEAR(-slope, wrench[axis], tolerance_n)
        << bench.spec().name << " axis " << axis << " at " << pose.position.transpose();
  }
}

void expect_stiffness_covers(Bench& bench, const Pose& pose, double tolerance, bool with_rotation,
                             double step) {
  const effects::EffectForce here = bench.at(pose);
  const int axes = with_rotation ? 6 : 3;
  Eigen::MatrixXd own(axes, axes);
  double bound = here.stiffness_bound_n_per_m;
  for (int axis = 0; axis < axes; ++axis) {
    const effects::EffectForce more = bench.at(moved(pose, axis, step)),
                               less = bench.at(moved(pose, axis, -step));
    own.col(axis) = -((as_vector(more.wrench) - as_vector(less.wrench)) / (2 * step)).head(axes);
    bound = std::max({bound, more.stiffness_bound_n_per_m, less.stiffness_bound_n_per_m});
  }
  const double found = Eigen::JacobiSVD<Mat3>(own.topLeftCorner<3, 3>()).singularValues()[0];
  EXPECT_LE(found, bound * (1 + 1e-6) + tolerance)
      << bench.spec().name << " at " << pose.position.transpose();
  EXPECT_LE(bound, effects::bound_of(bench.spec()).stiffness_n_per_m * (1 + 1e-9))
      << bench.spec().name;
  EXPECT_LE(here.wrench.force.norm(), effects::bound_of(bench.spec()).force_n * (1 + 1e-9))
      << bench.spec().name;
  EXPECT_TRUE(here.stiffness.isApprox(here.stiffness.transpose(), 1e-12) ||
              here.stiffness.isZero(1e-12));
  Eigen::MatrixXd given = here.stiffness.topLeftCorner(axes, axes);
  if (with_rotation)
    given.bottomRows(3) /= kLever, given.rightCols(3) /= kLever;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> itself(given, Eigen::EigenvaluesOnly);
  EXPECT_GE(itself.eigenvalues()[0], -1e-9 * (1 + bound))
      << bench.spec().name << " at " << pose.position.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> over(given - 0.5 * (own + own.transpose()),
                                                            Eigen::EigenvaluesOnly);
  EXPECT_GE(over.eigenvalues()[0], -1e-6 * bound - tolerance)
      << bench.spec().name << " at " << pose.position.transpose();
  if (!with_rotation)
    return;
  const Eigen::SelfAdjointEigenSolver<Mat3> rotation(here.stiffness.bottomRightCorner<3, 3>(),
                                                     Eigen::EigenvaluesOnly);
  EXPECT_LE(rotation.eigenvalues()[2],
            effects::bound_of(bench.spec()).stiffness_nm_per_rad * (1 + 1e-9));
}

std::vector<Pose> closed_path(Random& random, const Vec3& centre, double size_m,
                              double rotation_rad, std::size_t steps) {
  constexpr int kSines = 3;
  std::array<Vec3, 2 * kSines> swing, turn;
  for (Vec3& v : swing)
    v = random.vector(size_m / kSines);
  for (Vec3& v : turn)
    v = random.vector(rotation_rad / kSines);
  std::vector<Pose> path;
  for (std::size_t n = 0; n <= steps; ++n) {
    const double t =
        2.0 * std::numbers::pi * static_cast<double>(n % steps) / static_cast<double>(steps);
    Vec3 x = centre, r = Vec3::Zero();
    for (int k = 0; k < kSines; ++k) {
      const auto a = static_cast<std::size_t>(2 * k);
      x += std::sin((k + 1) * t) * swing[a] + std::cos((k + 1) * t) * swing[a + 1];
      r += std::sin((k + 1) * t) * turn[a] + std::cos((k + 1) * t) * turn[a + 1];
    }
    path.push_back(
        {x, r.norm() > 0.0 ? Quat(Eigen::AngleAxisd(r.norm(), r.normalized())) : Quat::Identity()});
  }
  return path;
}

Work work_along(Bench& bench, const std::vector<Pose>& path, bool with_rotation) {
  Work work;
  for (std::size_t n = 0; n + 1 < path.size(); ++n) {
    const Pose &a = path[n], &b = path[n + 1];
    const Wrench w =
        bench.at({0.5 * (a.position + b.position), a.orientation.slerp(0.5, b.orientation)}).wrench;
    const Eigen::AngleAxisd turn(b.orientation * a.orientation.conjugate());
    const double step = w.force.dot(b.position - a.position) +
                        (with_rotation ? turn.angle() * w.torque.dot(turn.axis()) : 0.0);
    work.net_j += step, work.moved_j += std::abs(step);
  }
  return work;
}

double steepest_on_sweep(Bench& bench, const Vec3& from, const Vec3& to, std::size_t steps,
                         double bound_n_per_m) {
  const double step = (to - from).norm() / static_cast<double>(steps);
  double steepest = 0.0;
  Vec3 last = bench.at({from, Quat::Identity()}).wrench.force;
  for (std::size_t n = 1; n <= steps; ++n) {
    const Vec3 x = from + static_cast<double>(n) / static_cast<double>(steps) * (to - from);
    const Vec3 force = bench.at({x, Quat::Identity()}).wrench.force;
    steepest = std::max(steepest, (force - last).norm() / (step * bound_n_per_m));
    last = force;
  }
  return steepest;
}

}  // namespace voxtouch::test
