#include "core/rendering/series_spring.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <vector>

namespace voxtouch::rendering {
namespace series_spring_test {

constexpr double kT = 1e-3, kCap = 1000.0;

/// Walls with a force along their normal n for n . x < at; F(d) of the depth.
struct Wall {
  Vec3 normal;
  double at_m = 0.0, stiffness = 0.0;
  double knee_m = 1e9, beyond = 1.0;  ///< from the knee on the stiffness is so many times itself
  double step_m = 0.0;                ///< depth counts in steps of this, as over voxels

  double force(double depth) const {
    if (depth <= 0.0)
      return 0.0;
    if (step_m > 0.0)
      depth = step_m * std::floor(depth / step_m + 0.5);
    return stiffness * (std::min(depth, knee_m) + beyond * std::max(0.0, depth - knee_m));
  }
  double slope(double depth) const {
    return depth <= 0.0 ? 0.0 : stiffness * (depth > knee_m ? beyond : 1.0);
  }
};

ContactAt contact_of(const std::vector<Wall>& walls, const Pose& tool) {
  ContactAt out;
  for (const Wall& wall : walls) {
    const double depth = wall.at_m - wall.normal.dot(tool.position);
    out.wrench.force += wall.force(depth) * wall.normal;
    out.stiffness.topLeftCorner<3, 3>() +=
        wall.slope(depth) * wall.normal * wall.normal.transpose();
  }
  return out;
}

struct Hand {
  explicit Hand(std::vector<Wall> of, double cap = kCap) : walls(std::move(of)) {
    spring.set_target({1.0 / cap, 0.0});
  }
  Vec3 at(const Vec3& position) {
    spring.begin({position, Quat::Identity()}, kT);
    while (spring.settle(contact_of(walls, spring.tool()))) {
    }
    lookups += spring.lookups(), ++samples;
    return spring.wrench().force;
  }
  std::vector<Wall> walls;
  SeriesSpring spring;
  int lookups = 0, samples = 0;
};

/// Two springs in series, from the first sample in contact on, and about one query per sample.
TEST(SeriesSpring, ActsAsTwoSpringsInSeries) {
  for (const double times : {0.1, 1.0, 10.0, 1000.0}) {
    Hand hand({{Vec3::UnitZ(), 0.0, times * kCap}});
    for (int n = 0; n <= 1000; ++n) {
      const double depth = 1e-5 * (n - 500), displayed = kCap * times / (1.0 + times);
      ASSERT_NEAR(hand.at({0, 0, -depth}).z(), displayed * std::max(0.0, depth), 1e-9) << n;
    }
    EXPECT_LE(hand.lookups, hand.samples + 3);
  }
}

TEST(SeriesSpring, IsTheCapAtTheStiffestContactAndNoSpringBelowIt) {
  EXPECT_EQ(compliance_for(1000.0, 900.0), 0.0);
  EXPECT_EQ(compliance_for(std::numeric_limits<double>::infinity(), 1e6), 0.0);
  const double c = compliance_for(1000.0, 3000.0);
  EXPECT_NEAR(1.0 / (c + 1.0 / 3000.0), 1000.0, 1e-9);
}

/// Walls that soften, harden and step, corners and slots: never steeper than the spring, and no
/// energy on closed paths.
TEST(SeriesSpring, IsNeverSteeperThanTheSpringAndGivesNoEnergy) {
  const Vec3 z = Vec3::UnitZ(), tilted = Vec3(std::sin(1.0), 0, std::cos(1.0));
  const std::vector<std::vector<Wall>> scenes{{{z, 0.0, 5e4, 5e-5, 0.02}},
                                              {{z, 0.0, 3e3, 1e-3, 30.0}},
                                              {{z, 0.0, 2e4}, {tilted, 0.0, 5e3}},
                                              {{z, 1e-3, 2e4}, {-z, 1e-3, 2e4}},
                                              {{z, -1e-4, 2e4}, {-z, -1e-4, 2e4}}};
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> u(-1, 1);
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    Hand hand(scenes[s]);
    Vec3 last = Vec3::Zero(), from(0, 0, 0);
    double energy_generated_j = 0.0, path_nm = 0.0, steepest = 0.0;
    for (int cycle = 0; cycle < 20; ++cycle) {
      std::vector<Vec3> corners;
      for (int n = 0; n < 4; ++n)
        corners.push_back(2e-3 * Vec3(u(random), 0, u(random)));
      corners.push_back(Vec3::Zero());
      for (const Vec3& to : corners)
        for (int n = 1; n <= 400; ++n) {
          const Vec3 now = from + (to - from) * n / 400.0,
                     before = n == 1 ? from : Vec3(from + (to - from) * (n - 1) / 400.0);
          const Vec3 force = hand.at(now);
          // The mean of both ends: energy of the zero-order hold is not the spring's.
          energy_generated_j += 0.5 * (force + last).dot(now - before),
              path_nm += force.norm() * (now - before).norm();
          if (cycle > 0 && !now.isApprox(before))
            steepest = std::max(steepest, (force - last).norm() / (now - before).norm());
          last = force;
          if (n == 400)
            from = to;
        }
    }
    std::printf(
        "scene %zu: steepest %.3f of the spring, %+.2e J of %.2e J, %.3f look-ups a sample\n", s,
        steepest / kCap, energy_generated_j, path_nm,
        static_cast<double>(hand.lookups) / hand.samples);
    EXPECT_LE(steepest, 1.05 * kCap) << s;
    EXPECT_LE(energy_generated_j, 0.01 * path_nm) << s;
  }
}

/// Within the tolerance of the equilibrium the force must not reverse: a wall does not pull when it
/// is left.
TEST(SeriesSpring, NeverPullsWhenLeavingAWall) {
  for (const double stiffness : {0.1, 1.0, 30.0}) {
    Hand hand({{Vec3::UnitZ(), 0.0, stiffness * kCap, 1e-5, 3.0}});
    for (int n = 0; n < 2000; ++n)
      ASSERT_GE(hand.at({0, 0, -1e-6 * (1000 - n) - 1e-8}).z(), 0.0) << stiffness << ' ' << n;
  }
}

/// A hand at rest on a wall that steps by voxels has a force at rest.
TEST(SeriesSpring, RestsOnAStepOfTheContact) {
  Hand hand({{Vec3::UnitZ(), 0.0, 2e4, 1e9, 1.0, 1e-4}});
  double low = 1e9, high = -1e9;
  for (int n = 0; n < 400; ++n) {
    const double force = hand.at({0, 0, -std::min(1e-5 * n, 1.23e-3)}).z();
    if (n > 200)
      low = std::min(low, force), high = std::max(high, force);
  }
  EXPECT_GT(low, 0.8);
  EXPECT_LE(high - low, 0.01);
}

TEST(SeriesSpring, OfMatricesNeverExceedsTheSpring) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(-1, 1);
  const Compliance spring{1.0 / 800.0, 1.0 / 0.5};
  for (int attempt = 0; attempt < 200; ++attempt) {
    Mat6 k = Mat6::Zero();
    for (int p = 0; p < 1 + attempt % 9; ++p) {
      const Vec3 dir = Vec3(u(random), u(random), u(random)).normalized(),
                 arm = 0.05 * Vec3(u(random), u(random), u(random));
      Vec6 j;
      j << dir, arm.cross(dir);
      k += std::pow(10.0, 3 + 2 * u(random)) * j * j.transpose();
    }
    const Vec6 n = (Vec6() << Vec3::Constant(std::sqrt(spring.translation)),
                    Vec3::Constant(std::sqrt(spring.rotation)))
                       .finished();
    const Mat6 in_units = n.asDiagonal() * in_series(k, spring) * n.asDiagonal();
    const auto values =
        Eigen::SelfAdjointEigenSolver<Mat6>(in_units, Eigen::EigenvaluesOnly).eigenvalues();
    ASSERT_LE(values.maxCoeff(), 1.0 + 1e-9);
    ASSERT_GE(values.minCoeff(), -1e-9);
  }
}

TEST(SeriesSpring, ChangesItsStiffnessWithoutAStep) {
  Hand hand({{Vec3::UnitZ(), 0.0, 1e5}});
  double last = 0.0;
  for (int n = 0; n < 200; ++n)
    last = hand.at({0, 0, -1e-5 * n}).z();
  hand.spring.set_target({0.5 / kCap, 0.0});
  double step = 0.0;
  for (int n = 0; n < 400; ++n) {
    const double now = hand.at({0, 0, -1.99e-3}).z();
    step = std::max(step, std::abs(now - last)), last = now;
  }
  EXPECT_NEAR(last, 1.99e-3 * 2.0 * kCap / 1.02, 0.02);
  EXPECT_LE(step, 0.02);
}

}  // namespace series_spring_test
}  // namespace voxtouch::rendering
