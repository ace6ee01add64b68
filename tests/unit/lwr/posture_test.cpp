#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <random>

#include "devices/arm/posture_torque.hpp"
#include "devices/lwr/lwr_arm.hpp"

namespace voxtouch::lwr {
namespace posture_test {

using arm::free_motion;
using arm::posture_torque;
using arm::PostureRules;

LwrJoints random_posture(std::mt19937& random) {
  const LwrLimits limits = lwr_limits();
  LwrJoints q;
  for (int i = 0; i < 7; ++i)
    q[i] = std::uniform_real_distribution(-0.95, 0.95)(random) * limits.position_rad[i];
  return q;
}

TEST(PostureTorque, MovesInTheNullSpaceOfTheTool) {
  std::mt19937 random(1);
  const LwrArm arm(Pose{Vec3(0.03, 0.0, 0.1), Quat::Identity()});
  for (int n = 0; n < 100; ++n) {
    const LwrJacobian jacobian = arm.jacobian(random_posture(random));
    const LwrJoints motion = free_motion(jacobian);
    EXPECT_LT((jacobian * motion).norm(), 1e-12);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(jacobian);
    EXPECT_NEAR(motion.norm(), svd.singularValues().prod(), 1e-9)
        << "its length is the manipulability";
  }
}

TEST(PostureTorque, IsAtRightAnglesToEveryTorqueOfAWrench) {
  std::mt19937 random(2);
  const PostureRules rules{.posture = lwr_rest_posture()};
  for (int n = 0; n < 100; ++n) {
    const LwrJoints q = random_posture(random);
    const LwrJacobian jacobian = LwrArm().jacobian(q);
    const LwrJoints torque = posture_torque(rules, jacobian, q, LwrJoints::Random());
    EXPECT_LE(torque.norm(), rules.max_torque_nm * (1 + 1e-12));
    const Wrench wrench{Vec3::Random(), Vec3::Random()};
    EXPECT_NEAR(torque.dot(joint_torque(jacobian, wrench)), 0.0, 1e-9);
  }
}

TEST(PostureTorque, RestoresAndDampsTheElbow) {
  const PostureRules rules{.posture = lwr_rest_posture()};
  const LwrArm arm;
  LwrJoints q = rules.posture;
  EXPECT_EQ(posture_torque(rules, arm.jacobian(q), q, LwrJoints::Zero()).norm(), 0.0);
  const LwrJoints n = free_motion(arm.jacobian(q)).normalized();
  q += 0.05 * n;
  const LwrJoints pull = posture_torque(rules, arm.jacobian(q), q, LwrJoints::Zero());
  EXPECT_LT(pull.dot(q - rules.posture), 0.0);
  EXPECT_NEAR(pull.norm(), 0.05 * rules.stiffness_nm_per_rad, 0.01);
  const LwrJoints brake =
      posture_torque(rules, arm.jacobian(rules.posture), rules.posture, 0.2 * n);
  EXPECT_NEAR(brake.dot(n), -0.2 * rules.damping_nms_per_rad, 1e-9);
}

TEST(PostureTorque, FadesAtSingularitiesAndForNan) {
  const PostureRules rules{.posture = lwr_rest_posture()};
  const LwrArm arm;
  const LwrJoints away = LwrJoints::Constant(0.5);
  EXPECT_EQ(posture_torque(rules, arm.jacobian(LwrJoints::Zero()), away, LwrJoints::Zero()).norm(),
            0.0)
      << "arm stretched";
  LwrJoints near = LwrJoints::Zero();
  near[3] = near[5] = near[1] = 0.05;
  EXPECT_LT(posture_torque(rules, arm.jacobian(near), near + away, LwrJoints::Zero()).norm(), 0.3);
  LwrJoints bad = LwrJoints::Zero();
  bad[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(posture_torque(rules, arm.jacobian(rules.posture), bad, LwrJoints::Zero()),
            LwrJoints::Zero());
  EXPECT_EQ(posture_torque(rules, arm.jacobian(bad), rules.posture, LwrJoints::Zero()),
            LwrJoints::Zero());
}

}  // namespace posture_test
}  // namespace voxtouch::lwr
