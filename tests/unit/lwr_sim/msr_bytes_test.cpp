// The measurement against the table of offsets, read at literal offsets: nothing of the packets'
// declaration is used.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/lwr_sim/rig.hpp"

namespace voxtouch::lwr_sim {
namespace {

using test::get;
using test::MsrBytes;
using test::Rig;

ControllerConfig exact() {
  ControllerConfig config;
  config.script_pause_s = 0.002;
  config.torque_noise_nm = 0.0;
  config.angle_resolution_rad = 0.0;
  config.virtual_time = true;
  return config;
}

TEST(MsrBytes, HeaderAndVariables) {
  Rig rig(exact());
  rig.remote.run = 0;
  for (int i = 1; i <= 5; ++i) {
    const MsrBytes msr = rig.period();
    EXPECT_EQ(get<std::uint16_t>(msr, 0), i);
    EXPECT_EQ(get<std::uint16_t>(msr, 2), i - 1);  // the answer before
    EXPECT_EQ(get<std::uint16_t>(msr, 4), 916);
    EXPECT_EQ(get<std::uint16_t>(msr, 6), 0x2006);
    EXPECT_EQ(get<std::int32_t>(msr, 76), 10);
    EXPECT_EQ(get<std::int32_t>(msr, 72 + 4 * 15), 0x56545854);
    EXPECT_FLOAT_EQ(get<float>(msr, 140), 1e-3F * static_cast<float>(i - 1));
    EXPECT_EQ(get<std::uint16_t>(msr, 144), 1);
    EXPECT_FLOAT_EQ(get<float>(msr, 148), 1e-3F);
    EXPECT_FLOAT_EQ(get<float>(msr, 152), 1e-3F);
    EXPECT_FLOAT_EQ(get<float>(msr, 156), 1.0F);
    EXPECT_EQ(get<std::uint16_t>(msr, 180), 0x7F);
    EXPECT_EQ(get<std::uint16_t>(msr, 182), 1);
    EXPECT_GT(get<float>(msr, 188), 0.0F);
  }
}

TEST(MsrBytes, TheMarkOfVirtualTimeIsAbsentInRealTime) {
  ControllerConfig config = exact();
  config.virtual_time = false;
  Rig rig(config);
  EXPECT_EQ(get<std::int32_t>(rig.period(), 132), 0);
}

TEST(MsrBytes, StatisticsCoverTheLastHundred) {
  Rig rig(exact());
  rig.remote.run = 0;
  rig.periods(300);
  for (int i = 0; i < 5; ++i) {
    rig.period(false);
    rig.periods(3);
  }
  const MsrBytes msr = rig.period();
  EXPECT_FLOAT_EQ(get<float>(msr, 160), 0.95F);
  EXPECT_FLOAT_EQ(get<float>(msr, 172), 0.05F);
  EXPECT_EQ(get<std::uint32_t>(msr, 176), 5u);
  EXPECT_FLOAT_EQ(get<float>(rig.periods(120), 160), 1.0F);
}

TEST(MsrBytes, GeometryAndDynamicsOfTheArm) {
  ControllerConfig config = exact();
  config.start_rad << 0.3, 0.6, -0.2, -1.4, 0.5, 0.9, -0.7;
  config.laws.task_frame_is_tool = false;
  config.hand_waits = false;
  Rig rig(config, test::arm_at(Vec3(0.05, 0.02, -0.03)));
  rig.remote.run = 0;
  const MsrBytes msr = rig.periods(3);
  const lwr::LwrArm::State arm = lwr::LwrArm().at(config.start_rad);
  const ArmDynamics::Terms terms =
      ArmDynamics(config.plant.bodies).at(config.start_rad, lwr::LwrJoints::Zero());
  for (std::size_t i = 0; i < 7; ++i) {
    const auto n = static_cast<Eigen::Index>(i);
    EXPECT_NEAR(get<float>(msr, 216 + 4 * i), config.start_rad[n], 1e-3);  // the hand pulls at it
    EXPECT_NEAR(get<float>(msr, 292 + 4 * i), config.start_rad[n], 1e-6);
    EXPECT_EQ(get<float>(msr, 320 + 4 * i), 0.0F);
    EXPECT_NEAR(get<float>(msr, 888 + 4 * i), terms.gravity[n], 0.05);
    for (std::size_t k = 0; k < 7; ++k)
      EXPECT_NEAR(get<float>(msr, 692 + 4 * (7 * i + k)),
                  terms.mass(n, static_cast<Eigen::Index>(k)), 0.01);
  }
  // Position in the fourth column of three rows.
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(get<float>(msr, 244 + 16 * static_cast<std::size_t>(axis) + 12),
                arm.pose_BT.position[axis], 1e-3);
    EXPECT_NEAR(get<float>(msr, 348 + 16 * static_cast<std::size_t>(axis) + 12),
                arm.pose_BT.position[axis], 1e-5);
  }
  EXPECT_NEAR(get<float>(msr, 244 + 4), arm.pose_BT.orientation.toRotationMatrix()(0, 1), 1e-3);
  // Rows of the Jacobian: x, y, z, then about z, y, x.
  const int rows[6] = {0, 1, 2, 5, 4, 3};
  for (int row = 0; row < 6; ++row)
    for (int col = 0; col < 7; ++col)
      EXPECT_NEAR(get<float>(msr, 524 + 4 * static_cast<std::size_t>(7 * row + col)),
                  arm.jacobian(rows[row], col), 2e-3);
}

TEST(MsrBytes, TheHandShowsInTheJointsAndAtTheTool) {
  ControllerConfig config = exact();
  config.laws.task_frame_is_tool = false;
  config.hand_waits = false;
  sim::OperatorConfig hand = *hand::grip("arm");
  const Pose tool = lwr::LwrArm().tool(config.start_rad);
  Motion motion;
  motion.path = {tool.position + Vec3(0.05, 0.0, 0.0)};
  motion.orientation = tool.orientation * Quat(Eigen::AngleAxisd(0.2, Vec3::UnitZ()));
  Rig rig(config, hand::Hand(hand, motion, kSubstep));
  rig.remote.run = 0;
  const MsrBytes msr =
      rig.periods(1500);  // position control holds; the hand pulls with 10 N and 1 Nm
  EXPECT_NEAR(get<float>(msr, 500), 10.0F, 0.05F);
  EXPECT_NEAR(get<float>(msr, 504), 0.0F, 0.05F);
  EXPECT_NEAR(get<float>(msr, 512), -1.0F, 0.05F);  // about z comes first; the tool points down
  EXPECT_NEAR(get<float>(msr, 520), 0.0F, 0.05F);
  const lwr::LwrJacobian jacobian = lwr::LwrArm().jacobian(rig.controller.plant().q());
  const lwr::LwrJoints outer = lwr::joint_torque(jacobian, rig.controller.plant().hand_wrench());
  const lwr::LwrJoints gravity = rig.controller.plant().terms().gravity;
  for (std::size_t i = 0; i < 7; ++i) {
    const auto n = static_cast<Eigen::Index>(i);
    EXPECT_NEAR(get<float>(msr, 472 + 4 * i), outer[n], 0.02);
    EXPECT_NEAR(get<float>(msr, 444 + 4 * i), gravity[n] - outer[n],
                0.3);  // measured by the sensors; friction in addition
  }
}

TEST(MsrBytes, SensorsHaveTheirStatedNoise) {
  ControllerConfig config = exact();
  config.torque_noise_nm = 0.2;
  Rig rig(config);
  rig.remote.run = 0;
  double sum = 0.0, squares = 0.0;
  constexpr int kCount = 2000;
  for (int i = 0; i < kCount; ++i) {
    const double value = get<float>(rig.period(), 472);
    sum += value, squares += value * value;
  }
  EXPECT_NEAR(sum / kCount, 0.0, 0.02);
  EXPECT_NEAR(std::sqrt(squares / kCount), 0.2, 0.02);
}

TEST(MsrBytes, OffsetIsTheRemoteSidesAdditionInCommandMode) {
  ControllerConfig config = exact();
  Rig rig(config);
  rig.remote.strategy = 10;
  rig.remote.flags = 1;
  rig.remote.follows = false;
  rig.remote.step = 1e-4F;
  ASSERT_TRUE(rig.start());
  const float commanded = get<float>(rig.period(), 292);
  const MsrBytes msr = rig.periods(500);
  EXPECT_EQ(get<float>(msr, 292), commanded);
  EXPECT_NEAR(get<float>(msr, 320), 0.05F, 3e-4F);
  EXPECT_NEAR(test::joint(msr, 0), commanded + get<float>(msr, 320), 5e-3F);
  EXPECT_NEAR(get<float>(msr, 324), 0.0F, 1e-6F);  // rounding of floats
}

}  // namespace
}  // namespace voxtouch::lwr_sim
