#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "devices/lwr/lwr_arm.hpp"

namespace voxtouch::lwr {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

LwrJoints degrees(std::initializer_list<double> values) {
  LwrJoints q;
  int i = 0;
  for (const double value : values)
    q[i++] = value * kRadPerDeg;
  return q;
}

/// A tool off the flange's axis and rotated, so that no term vanishes.
Pose odd_tool() { return {Vec3(0.02, -0.03, 0.11), Quat(0.5, -0.1, 0.7, 0.3).normalized()}; }

LwrJoints random_posture(std::mt19937& random) {
  const LwrLimits limits = lwr_limits();
  LwrJoints q;
  for (int i = 0; i < 7; ++i)
    q[i] = std::uniform_real_distribution(-0.95, 0.95)(random) * limits.position_rad[i];
  return q;
}

TEST(LwrArm, StandsUprightAtZeroWithTheSumOfItsLengths) {
  const Pose flange = LwrArm().flange(LwrJoints::Zero());
  EXPECT_NEAR((flange.position - Vec3(0, 0, 0.3105 + 0.4 + 0.39 + 0.078)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(flange.orientation.angularDistance(Quat::Identity()), 0.0, 1e-7);
}

TEST(LwrArm, ReachesThePublishedPointWithTheElbowBent) {
  const Pose flange = LwrArm().flange(lwr_rest_posture());
  EXPECT_NEAR((flange.position - Vec3(-0.538, 0.0, 0.384)).norm(), 0.0, 5e-4)
      << flange.position.transpose();
}

TEST(LwrArm, ToolFollowsTheFlange) {
  const LwrJoints q = degrees({10, -20, 30, 40, -50, 60, 70});
  const Pose flange = LwrArm().flange(q), tool = LwrArm(odd_tool()).tool(q);
  EXPECT_NEAR((tool.position - flange * odd_tool().position).norm(), 0.0, 1e-12);
  EXPECT_NEAR(tool.orientation.angularDistance(flange.orientation * odd_tool().orientation), 0.0,
              1e-7);
}

TEST(LwrArm, HasTheJacobianOfItsOwnKinematics) {
  std::mt19937 random(7);
  const LwrArm arm(odd_tool());
  constexpr double kStep = 1e-6;
  for (int n = 0; n < 50; ++n) {
    const LwrJoints q = random_posture(random);
    const LwrJacobian jacobian = arm.jacobian(q);
    for (int joint = 0; joint < 7; ++joint) {
      const LwrJoints turn = kStep * LwrJoints::Unit(joint);
      const Pose ahead = arm.tool(q + turn), behind = arm.tool(q - turn);
      const Vec3 linear = (ahead.position - behind.position) / (2 * kStep);
      const Eigen::AngleAxisd between(ahead.orientation * behind.orientation.conjugate());
      const Vec3 angular = between.axis() * between.angle() / (2 * kStep);
      EXPECT_NEAR((jacobian.col(joint).head<3>() - linear).norm(), 0.0, 1e-8);
      EXPECT_NEAR((jacobian.col(joint).tail<3>() - angular).norm(), 0.0, 1e-8);
    }
  }
}

TEST(LwrArm, DoesTheWorkOfTheWrenchInItsJoints) {
  std::mt19937 random(8);
  const LwrArm arm(odd_tool());
  for (int n = 0; n < 20; ++n) {
    const LwrJoints q = random_posture(random), rate = LwrJoints::Random();
    const Wrench wrench{Vec3(3, -4, 5), Vec3(-0.1, 0.2, 0.3)};
    const Vec6 twist = arm.jacobian(q) * rate;
    EXPECT_NEAR(joint_torque(arm.jacobian(q), wrench).dot(rate),
                wrench.force.dot(twist.head<3>()) + wrench.torque.dot(twist.tail<3>()), 1e-12);
  }
}

TEST(LwrArm, HasTheSmallerOfThePublishedLimits) {
  const LwrLimits limits = lwr_limits();
  EXPECT_DOUBLE_EQ(limits.position_rad[1], 120 * kRadPerDeg);
  EXPECT_DOUBLE_EQ(limits.velocity_rad_s[0], 110 * kRadPerDeg);
  EXPECT_DOUBLE_EQ(limits.velocity_rad_s[3], 112.5 * kRadPerDeg);
  EXPECT_DOUBLE_EQ(limits.velocity_rad_s[4], 180 * kRadPerDeg)
      << "A4 of the controller is the fifth joint";
  EXPECT_DOUBLE_EQ(limits.torque_nm[0], 176);
  EXPECT_DOUBLE_EQ(limits.torque_nm[6], 30);
}

TEST(LwrArm, GivesNoNumberForAnInvalidPosture) {
  LwrJoints q = lwr_rest_posture();
  q[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(LwrArm().tool(q).finite());
}

}  // namespace
}  // namespace voxtouch::lwr
