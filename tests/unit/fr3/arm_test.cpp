// The driver's kinematics against the simulated arm's bodies, which were placed by hand, and
// against figures that are published.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "devices/fr3/simulated/fr3_plant.hpp"

namespace voxtouch::fr3 {
namespace arm_test {

const Pose kTool{Vec3(0.03, -0.02, 0.1),
                 Quat(Eigen::AngleAxisd(0.4, Vec3(1.0, 2.0, -1.0).normalized()))};

TEST(Fr3Arm, StretchedFlangeIsTheSumOfTheRows) {
  const Pose flange = Fr3Arm().at(Joints::Zero()).flange;
  EXPECT_LT((flange.position - Vec3(0.088, 0.0, 0.333 + 0.316 + 0.384 - 0.107)).norm(), 1e-12);
  EXPECT_LT((flange.orientation * Vec3::UnitZ() + Vec3::UnitZ()).norm(), 1e-12)
      << "the flange looks down";
}

TEST(Fr3Arm, FlangePointsDownAtRest) {
  const Pose flange = Fr3Arm().at(fr3_rest_posture()).flange;
  EXPECT_LT((flange.position - Vec3(0.3069, 0.0, 0.5903)).norm(), 1e-3);
  EXPECT_LT((flange.orientation * Vec3::UnitZ() + Vec3::UnitZ()).norm(), 1e-9);
}

TEST(Fr3Arm, IsTheSameArmAsTheSimulatedOne) {
  std::mt19937 random(1);
  const Fr3Arm arm(kTool);
  const arm_sim::PlantParameters plant = fr3_sim::fr3_plant(kTool);
  const arm_sim::ArmDynamics dynamics(plant.bodies, plant.pose_FT);
  for (int n = 0; n < 100; ++n) {
    Joints q;
    for (int i = 0; i < 7; ++i)
      q[i] = std::uniform_real_distribution(plant.lowest_rad[i], plant.highest_rad[i])(random);
    const Fr3Arm::State state = arm.at(q);
    const arm_sim::ArmDynamics::Terms terms = dynamics.at(q, Joints::Zero());
    EXPECT_LT((state.pose_BT.position - terms.tool.position).norm(), 1e-12);
    EXPECT_LT(state.pose_BT.orientation.angularDistance(terms.tool.orientation), 1e-7);
    EXPECT_LT((state.jacobian - terms.jacobian).norm(), 1e-12);
  }
}

TEST(Fr3Arm, MassAtTheToolMatchesTheDeviceFile) {
  const arm_sim::PlantParameters plant = fr3_sim::fr3_plant();
  const arm_sim::ArmDynamics::Terms terms =
      arm_sim::ArmDynamics(plant.bodies, plant.pose_FT).at(fr3_rest_posture(), Joints::Zero());
  const Mat3 mobility =
      (terms.jacobian * terms.mass.inverse() * terms.jacobian.transpose()).topLeftCorner<3, 3>();
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GT(1.0 / mobility(axis, axis), 1.5) << axis;
    EXPECT_LT(1.0 / mobility(axis, axis), 6.0) << axis;
  }
  double mass = 0.0;
  for (const arm_sim::Link& link : plant.bodies.links) {
    mass += link.mass_kg;
    EXPECT_GT(link.inertia_kg_m2.minCoeff(), 0.0);
    EXPECT_NEAR(link.axes.determinant(), 1.0, 1e-9);
  }
  EXPECT_NEAR(mass, 15.5, 0.3) << "of about 18 kg, the base left out";
  EXPECT_LT(terms.gravity.cwiseAbs().maxCoeff(), 45.0);
}

}  // namespace arm_test
}  // namespace voxtouch::fr3
