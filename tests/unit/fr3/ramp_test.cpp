#include "devices/fr3/torque_ramp.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>
#include <random>

#include "devices/fr3/fr3_arm.hpp"

namespace voxtouch::fr3 {
namespace ramp_test {

constexpr double kStep = 0.95;
const Joints kMax = (Joints() << 60, 45, 60, 45, 10, 10, 10).finished();
const Jacobian kJacobian = Fr3Arm().at(fr3_rest_posture()).jacobian;

Vec6 wrench_of(const Joints& torque) {
  const Mat6 square = kJacobian * kJacobian.transpose();
  return square.inverse() * (kJacobian * torque);
}

TEST(TorqueRamp, GoesAlongAStraightLineInStepsAndArrivesExactly) {
  TorqueRamp ramp(kStep, kMax);
  const Wrench expected{Vec3(20.0, -10.0, 15.0), Vec3(0.5, 0.0, -0.5)};
  Joints last = Joints::Zero();
  int steps = 0;
  for (bool arrived = false; !arrived && steps < 100; ++steps) {
    ramp.acknowledge(last);
    const Joints torque = ramp.next(kJacobian, expected, Joints::Zero());
    EXPECT_LE((torque - last).cwiseAbs().maxCoeff(), kStep + 1e-12);
    EXPECT_LE(wrench_of(torque).head<3>().norm(), expected.force.norm() * (1 + 1e-9))
        << "never more than both ends";
    last = torque;
    arrived = (torque - arm::joint_torque(kJacobian, expected)).norm() < 1e-12;
  }
  EXPECT_GE(steps, 8);
  EXPECT_LT(steps, 20);
  for (int i = 0; i < steps; ++i) {
    ramp.acknowledge(last);
    const Joints torque = ramp.next(kJacobian, {}, Joints::Zero());
    EXPECT_LE((torque - last).cwiseAbs().maxCoeff(), kStep + 1e-12);
    last = torque;
  }
  EXPECT_TRUE(last.isZero(0.0)) << "zero is zero and no small number";
  EXPECT_TRUE(ramp.at_rest());
}

TEST(TorqueRamp, LostCommandIsNotCountedAsApplied) {
  TorqueRamp ramp(kStep, kMax);
  const Wrench expected{Vec3(40.0, 0.0, 0.0), Vec3::Zero()};
  std::mt19937 random(2);
  Joints robot = Joints::Zero();
  for (int n = 0; n < 500; ++n) {
    ramp.acknowledge(robot);
    const Joints torque = ramp.next(kJacobian, n / 50 % 2 ? Wrench{} : expected, Joints::Zero());
    if (random() % 3 == 0)
      continue;
    EXPECT_LE((torque - robot).cwiseAbs().maxCoeff(), 1.0)
        << "the robot sees no jump, whatever was lost";
    robot = torque;
  }
}

TEST(TorqueRamp, ClaimsBeyondTheLastCommandsAreIgnored) {
  TorqueRamp ramp(kStep, kMax);
  for (int n = 0; n < 100; ++n) {
    ramp.acknowledge(Joints::Constant(n % 2 ? 1e30 : std::numeric_limits<double>::quiet_NaN()));
    const Joints torque = ramp.next(kJacobian, {}, Joints::Zero());
    EXPECT_TRUE(torque.isZero(0.0));
  }
}

TEST(TorqueRamp, EndsAtZeroDespiteAConstantReply) {
  for (const double word : {0.5, std::numeric_limits<double>::quiet_NaN()}) {
    TorqueRamp ramp(kStep, kMax);
    for (int n = 0; n < 200; ++n)
      ramp.acknowledge(Joints::Constant(word)),
          ramp.next(kJacobian, {Vec3(20, 0, 0), Vec3::Zero()}, Joints::Zero());
    for (int n = 0; n < 400; ++n)
      ramp.acknowledge(Joints::Constant(word)), ramp.next(kJacobian, {}, Joints::Zero());
    EXPECT_TRUE(ramp.at_rest()) << word;
  }
}

TEST(TorqueRamp, StaysWithinTheJointLimits) {
  TorqueRamp ramp(kStep, kMax);
  Joints torque;
  for (int n = 0; n < 500; ++n) {
    torque = ramp.next(kJacobian, {Vec3(1000.0, 1000.0, 1000.0), Vec3::Zero()}, Joints::Zero());
    ramp.acknowledge(torque);
    ASSERT_TRUE((torque.array().abs() <= kMax.array()).all());
  }
  EXPECT_GT((torque.array().abs() / kMax.array()).maxCoeff(), 0.99);
}

}  // namespace ramp_test
}  // namespace voxtouch::fr3
