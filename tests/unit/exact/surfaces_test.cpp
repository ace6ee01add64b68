/// Directions and sizes of the force on surfaces with closed forms.
#include <gtest/gtest.h>

#include <random>

#include "tests/unit/exact/rig.hpp"

namespace voxtouch::exact {
namespace {

/// Directions of the force's error and shortfall at random places, pressed in radially.
struct Errors {
  std::vector<double> angles, shortfalls;
  double angle_at(double part) {
    std::sort(angles.begin(), angles.end());
    return angles[static_cast<std::size_t>(part * static_cast<double>(angles.size() - 1))];
  }
  double mean_shortfall() const {
    double sum = 0.0;
    for (const double s : shortfalls)
      sum += s;
    return sum / static_cast<double>(shortfalls.size());
  }
};

TEST(Surfaces, OnAPlaneTheForceIsExact) {
  Rig rig(test::ball(0.01, 3), test::box({-0.1, -0.1, -0.02}, {0.1, 0.1, 0.0}));
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 20; ++k) {
    const Pose above{{0.03 * normal(random), 0.03 * normal(random), 0.012}, Quat::Identity()};
    Pose hand = above;
    hand.position.z() = 0.0;
    ASSERT_TRUE(rig.virtual_tool.place(above, {&rig.object_pose, 1}));
    const VirtualToolFrame frame = rig.lead(above, hand, 60);
    EXPECT_LT(angle_between(-frame.shift, Vec3::UnitZ()), 1e-9);
    EXPECT_NEAR(-frame.shift.z(), 0.01, 2e-4);  // the ball's lowest facet is not below its radius
    EXPECT_NEAR(frame.displayed(2, 2), 1.0, 1e-12);
    EXPECT_FALSE(rig.intersects());
  }
}

TEST(Surfaces, ATiltedBoxHoldsWithTheForceAlongItsNormal) {
  const Quat tilt = turned(0.3, {1, 2, 0.5});
  Rig rig(test::ball(0.01, 3),
          test::moved(test::box({-0.1, -0.1, -0.02}, {0.1, 0.1, 0.0}), {Vec3::Zero(), tilt}));
  const Vec3 n = tilt * Vec3::UnitZ();
  ASSERT_TRUE(rig.virtual_tool.place({0.02 * n, Quat::Identity()}, {&rig.object_pose, 1}));
  rig.lead({0.02 * n, Quat::Identity()}, {Vec3::Zero(), Quat::Identity()}, 60);
  const VirtualToolFrame frame = rig.rest({Vec3::Zero(), Quat::Identity()}, 10);
  EXPECT_LT(angle_between(-frame.shift, n), 1e-6);
}

TEST(Surfaces, OnACylinderTheErrorIsTheFacets) {
  constexpr double kRadius = 0.02, kBall = 0.01, kDepth = 0.001;
  Rig rig(test::ball(kBall, 4), test::prism(test::circle(kRadius, 625), -0.03, 0.03));
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Errors errors;
  for (int k = 0; k < 60; ++k) {
    const double angle = std::numbers::pi * uniform(random);
    const Vec3 n(std::cos(angle), std::sin(angle), 0.0), along(0.0, 0.0, 0.01 * uniform(random));
    const Pose out{n * (kRadius + kBall + 0.001) + along, turned(3.0 * uniform(random), {1, 2, 3})};
    const Pose in{n * (kRadius + kBall - kDepth) + along, out.orientation};
    ASSERT_TRUE(rig.virtual_tool.place(out, {&rig.object_pose, 1}));
    rig.lead(out, in, 20);
    const VirtualToolFrame frame = rig.rest(in, 40);
    errors.angles.push_back(angle_between(-frame.shift, n));
    errors.shortfalls.push_back(1.0 - frame.shift.norm() / kDepth);
    EXPECT_FALSE(rig.intersects());
  }
  EXPECT_LT(errors.angle_at(0.95), 2.0 * kDegree);
  EXPECT_LT(errors.mean_shortfall(), 0.02);
  EXPECT_GT(errors.mean_shortfall(), -0.001);
}

TEST(Surfaces, InABowlTheForceLeadsToItsMiddle) {
  constexpr double kInner = 0.03, kBall = 0.01, kDepth = 0.001;
  Rig rig(test::ball(kBall, 4), test::bowl(kInner, 0.034, 96, 24));
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Errors errors;
  for (int k = 0; k < 40; ++k) {
    const Vec3 n = -Vec3(uniform(random), uniform(random), -1.0).normalized();
    const Pose out{-n * (kInner - kBall - 0.002), turned(3.0 * uniform(random), {1, 2, 3})};
    const Pose in{-n * (kInner - kBall + kDepth), out.orientation};
    ASSERT_TRUE(rig.virtual_tool.place(out, {&rig.object_pose, 1}));
    rig.lead(out, in, 20);
    const VirtualToolFrame frame = rig.rest(in, 60);
    errors.angles.push_back(angle_between(-frame.shift, n));
    EXPECT_FALSE(rig.intersects());
  }
  EXPECT_LT(errors.angle_at(0.95), 4.0 * kDegree);  // facets of 3.75 degrees
}

TEST(Surfaces, TiltedBoxComesToRestFlat) {
  Rig rig(test::box({-.005, -.004, -.01}, {.005, .004, .01}),
          test::box({-0.1, -0.1, -0.02}, {0.1, 0.1, 0.0}));
  const Pose start{{0, 0, 0.02}, turned(0.15, {1, 0.6, 0})};
  ASSERT_TRUE(rig.virtual_tool.place(start, {&rig.object_pose, 1}));
  const Pose in{{0, 0, -0.02}, start.orientation};
  rig.lead(start, in, 400);
  const VirtualToolFrame frame = rig.rest(in, 200);
  EXPECT_LT(angle_between(frame.tool.orientation * Vec3::UnitZ(), Vec3::UnitZ()), 1e-4);
  EXPECT_NEAR(frame.tool.position.z(), 0.01, 3e-6);
  const VirtualToolFrame next = rig.frame(in);
  EXPECT_EQ(next.tool, frame.tool);
}

}  // namespace
}  // namespace voxtouch::exact
