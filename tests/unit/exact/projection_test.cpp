#include "core/exact/projection.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <bit>
#include <optional>
#include <random>

namespace voxtouch::exact {
namespace {

std::vector<Halfspace> random_rows(std::mt19937& random, int count) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<Halfspace> rows(static_cast<std::size_t>(count));
  for (Halfspace& row : rows) {
    const Vec3 n = Vec3(normal(random), normal(random), normal(random)).normalized();
    const Vec3 arm(normal(random), normal(random), normal(random));
    row.jacobian << n, arm.cross(n);
    row.least_m = -1e-3 * uniform(random) * (uniform(random) < 0.3 ? 0.0 : 1.0);
  }
  return rows;
}

bool keeps_all(const std::vector<Halfspace>& rows, const Vec6& delta, double tolerance) {
  for (const Halfspace& row : rows)
    if (row.jacobian.dot(delta) < row.least_m - tolerance)
      return false;
  return true;
}

/// The solution by trying every set of up to six active rows.
std::optional<Vec6> by_enumeration(const std::vector<Halfspace>& rows, const Vec6& target) {
  std::optional<Vec6> best;
  const std::size_t sets = std::size_t{1} << rows.size();
  for (std::size_t set = 0; set < sets; ++set) {
    if (std::popcount(set) > 6)
      continue;
    Eigen::MatrixXd n(6, std::popcount(set));
    Eigen::VectorXd least(std::popcount(set));
    Eigen::Index at = 0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      if ((set >> k & 1) == 0)
        continue;
      n.col(at) = rows[k].jacobian;
      least[at++] = rows[k].least_m;
    }
    Vec6 delta = target;
    if (at > 0) {
      const Eigen::MatrixXd gram = n.transpose() * n;
      const Eigen::VectorXd forces = gram.ldlt().solve(least - n.transpose() * target);
      delta += n * forces;
    }
    if (!delta.allFinite() || !keeps_all(rows, delta, 1e-10))
      continue;
    if (!best || (delta - target).norm() < (*best - target).norm())
      best = delta;
  }
  return best;
}

TEST(Projection, IsTheNearestStepThatKeepsAllRows) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  int with_six = 0;
  for (int k = 0; k < 300; ++k) {
    const std::vector<Halfspace> rows = random_rows(random, 1 + k % 11);
    Vec6 target;
    for (Eigen::Index n = 0; n < 6; ++n)
      target[n] = 3e-3 * normal(random);
    Work work;
    const Projection found = project(rows, target, work);
    ASSERT_TRUE(found.feasible && found.converged);
    const std::optional<Vec6> truth = by_enumeration(rows, target);
    ASSERT_TRUE(truth);
    EXPECT_TRUE(keeps_all(rows, found.delta, 1e-11));
    EXPECT_NEAR((found.delta - target).norm(), (*truth - target).norm(), 1e-10);
    EXPECT_NEAR((found.delta - *truth).norm(), 0.0, 1e-8);
    with_six += found.count == 6;
  }
  EXPECT_GT(with_six, 3);
}

TEST(Projection, ForcesBalanceTheTargetAndNonePulls) {
  std::mt19937 random(12);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 200; ++k) {
    const std::vector<Halfspace> rows = random_rows(random, 200);
    Vec6 target;
    for (Eigen::Index n = 0; n < 6; ++n)
      target[n] = 3e-3 * normal(random);
    Work work;
    const Projection found = project(rows, target, work);
    ASSERT_TRUE(found.feasible && found.converged);
    EXPECT_TRUE(keeps_all(rows, found.delta, 1e-11));
    Vec6 balance = target - found.delta;
    for (std::size_t n = 0; n < found.count; ++n) {
      EXPECT_GE(found.forces_m[n], 0.0);
      balance += found.forces_m[n] * rows[found.active[n]].jacobian;
      EXPECT_NEAR(rows[found.active[n]].jacobian.dot(found.delta), rows[found.active[n]].least_m,
                  1e-11);
    }
    EXPECT_NEAR(balance.norm(), 0.0, 1e-14);
    EXPECT_NEAR((found.held * found.held - found.held).norm(), 0.0, 1e-12);
  }
}

TEST(Projection, WithoutRowsIsExactlyTheTarget) {
  Vec6 target;
  target << 0.1, -0.2, 0.3, 1e-9, 1e300, -0.0;
  Work work;
  EXPECT_EQ(project({}, target, work).delta, target);
}

TEST(Projection, RowsThatDependOnEachOtherDoNotDisturb) {
  // A box on its four lower corners, and each of them twice.
  std::vector<Halfspace> rows;
  for (int k = 0; k < 8; ++k) {
    const Vec3 arm((k & 1) ? 0.5 : -0.5, (k & 2) ? 0.7 : -0.7, -0.2);
    Halfspace row;
    row.jacobian << Vec3::UnitZ(), arm.cross(Vec3::UnitZ());
    rows.push_back(row);
  }
  Vec6 target;
  target << 1e-3, 2e-3, -5e-3, 1e-4, -2e-4, 3e-4;
  Work work;
  const Projection found = project(rows, target, work);
  Vec6 truth = target;
  truth.segment<3>(2).setZero();
  EXPECT_TRUE(found.converged);
  EXPECT_NEAR((found.delta - truth).norm(), 0.0, 1e-12);
}

TEST(Projection, OpposingRowsThatLeaveNoStepAreReported) {
  std::vector<Halfspace> rows(2);
  rows[0].jacobian << Vec3::UnitX(), Vec3::Zero();
  rows[1].jacobian << -Vec3::UnitX(), Vec3::Zero();
  rows[0].least_m = rows[1].least_m = 1e-7;
  Work work;
  EXPECT_FALSE(project(rows, Vec6::Ones(), work).feasible);
  rows[0].least_m = rows[1].least_m = 0.0;
  const Projection closed = project(rows, Vec6::Ones(), work);
  EXPECT_TRUE(closed.feasible);
  EXPECT_EQ(closed.delta[0], 0.0);
}

}  // namespace
}  // namespace voxtouch::exact
