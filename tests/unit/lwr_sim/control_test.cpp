// The arm under the controller's laws, and with a hand at its tool.
#include <gtest/gtest.h>

#include <cmath>

#include "devices/arm/simulated/start_posture.hpp"
#include "tests/unit/lwr_sim/rig.hpp"

namespace voxtouch::lwr_sim {
namespace {

using test::arm_at;
using test::released_hand;
using test::Rig;

ControllerConfig quick() {
  ControllerConfig config;
  config.script_pause_s = 0.002;
  config.torque_noise_nm = 0.0;
  config.laws.task_frame_is_tool = false;
  return config;
}

Vec3 tip_of(const Rig& rig) { return rig.controller.plant().terms().tool.position; }

/// Sets the remote side's torques to J^T F at the arm's posture.
void push(Rig& rig, const Vec3& force) {
  const lwr::LwrJoints torque =
      lwr::joint_torque(lwr::LwrArm().jacobian(rig.controller.plant().q()), {force, Vec3::Zero()});
  for (std::size_t i = 0; i < 7; ++i)
    rig.remote.torque[i] = static_cast<float>(torque[static_cast<Eigen::Index>(i)]);
}

TEST(Control, InMonTheArmStandsStiffAgainstTheHand) {
  ControllerConfig config = quick();
  config.hand_waits = false;
  Rig rig(config, arm_at(Vec3(0.1, 0.1, 0.1)));
  rig.remote.run = 0;
  const Vec3 start = tip_of(rig);
  rig.periods(1000);
  EXPECT_LT((tip_of(rig) - start).norm(), 1e-3);
}

TEST(Control, HandWaitsForCommandModeByDefault) {
  Rig rig(quick(), arm_at(Vec3(0.1, 0.0, 0.0)));
  rig.remote.run = 0;
  rig.periods(200);
  EXPECT_TRUE(rig.controller.plant().hand_wrench().zero());
  rig.remote.run = 1;
  ASSERT_TRUE(rig.start());
  rig.periods(200);
  EXPECT_FALSE(rig.controller.plant().hand_wrench().zero());
}

TEST(Control, WithoutStiffnessTheHandLeadsTheArm) {
  Rig rig(quick(), arm_at(Vec3(0.04, -0.03, 0.02)));
  const Vec3 start = tip_of(rig);
  ASSERT_TRUE(rig.start());
  rig.periods(6000);
  // Friction stops it a little before: a newton over the hand's 200 N/m.
  EXPECT_LT((tip_of(rig) - start - Vec3(0.04, -0.03, 0.02)).norm(), 0.006);
  EXPECT_EQ(rig.controller.state(), lwr::fri::State::kCmd);
}

TEST(Control, ATorqueOnTopIsAForceAtTheToolThatTheHandHolds) {
  ControllerConfig config = quick();
  config.plant.coulomb_nm.setZero();
  Rig rig(config, arm_at(Vec3::Zero(), 500.0, 60.0));
  const Vec3 start = tip_of(rig);
  ASSERT_TRUE(rig.start());
  const Vec3 force(8.0, -5.0, 3.0);
  for (int i = 0; i < 4000; ++i) {
    push(rig, force);
    rig.period();
  }
  EXPECT_LT((500.0 * (tip_of(rig) - start) - force).norm(), 0.1);
  EXPECT_LT((rig.controller.row().applied.force - force).norm(), 0.1);
  EXPECT_LT((rig.controller.row().hand.force + force).norm(),
            0.2);  // the elbow still swings a little
}

TEST(Control, TorqueArrivesAfterItsDelay) {
  ControllerConfig config = quick();
  config.torque_delay_ticks = 2;
  Rig rig(config);
  ASSERT_TRUE(rig.start());
  rig.periods(20);
  rig.remote.torque[0] = 4.0F;
  const auto applied_force = [&] { return rig.controller.row().applied.force.norm(); };
  rig.period();  // the answer is received here
  EXPECT_NEAR(applied_force(), 0.0, 1e-3);
  rig.periods(2);  // and waits
  EXPECT_NEAR(applied_force(), 0.0, 1e-3);
  rig.period();
  const double first = applied_force();
  EXPECT_GT(first, 0.01);
  rig.periods(2);
  const double third = applied_force();
  rig.periods(30);
  EXPECT_NEAR(first / applied_force(), 1.0 - std::exp(-1.0 / 3.0), 0.08);
  EXPECT_NEAR(third / applied_force(), 1.0 - std::exp(-1.0), 0.08);
}

TEST(Control, JointStiffnessResistsTheHandAsConfigured) {
  ControllerConfig config = quick();
  config.plant.coulomb_nm.setZero();
  Rig rig(config, arm_at(Vec3(0.05, 0.0, 0.0)));
  rig.remote.joint_stiffness = 300.0F;
  rig.remote.follows = false;
  ASSERT_TRUE(rig.start());
  rig.periods(4000);
  const lwr::LwrJoints off = rig.controller.plant().q() - quick().start_rad;
  const ArmDynamics::Terms terms = rig.controller.plant().terms();
  const lwr::LwrJoints hand =
      lwr::joint_torque(terms.jacobian, rig.controller.plant().hand_wrench());
  EXPECT_LT((300.0 * off - hand).norm(), 0.05);
  EXPECT_GT(off.norm(), 0.005);
}

TEST(Control, ImpedanceIsDampedAsConfigured) {
  ControllerConfig config = quick();
  config.plant.coulomb_nm.setZero();
  Rig rig(config);
  rig.remote.joint_stiffness = 400.0F;
  rig.remote.follows = false;
  ASSERT_TRUE(rig.start());
  rig.periods(50);
  rig.remote.torque[1] = 20.0F;  // to 0.05 rad
  double most = 0.0;
  const double start = rig.controller.plant().q()[1];
  for (int i = 0; i < 3000; ++i) {
    rig.period();
    most = std::max(most, rig.controller.plant().q()[1] - start);
  }
  const double end = rig.controller.plant().q()[1] - start;
  EXPECT_NEAR(end, 20.0 / 400.0, 2e-3);
  EXPECT_GT(most / end, 1.005);  // of damping 0.7: 5 % over
  EXPECT_LT(most / end, 1.10);
}

TEST(Control, LongerPeriodsAreInterpolated) {
  ControllerConfig config = quick();
  config.period_s = 0.01;
  Rig rig(config);
  rig.remote.strategy = 10;
  rig.remote.flags = 1;
  rig.remote.follows = false;
  rig.remote.step = 5e-3F;  // 0.5 rad/s
  ASSERT_TRUE(rig.start());
  rig.periods(40);
  double least = 10.0, most = 0.0;
  for (int i = 0; i < 10; ++i) {
    rig.period();
    least = std::min(least, rig.controller.plant().rate()[0]);
    most = std::max(most, rig.controller.plant().rate()[0]);
  }
  EXPECT_NEAR(least, 0.5, 0.01);
  EXPECT_NEAR(most, 0.5, 0.01);
  EXPECT_EQ(rig.controller.state(), lwr::fri::State::kCmd);
}

TEST(Control, ASingleMissIsExtrapolated) {
  ControllerConfig config = quick();
  config.period_s = 0.004;
  Rig rig(config);
  rig.remote.strategy = 10;
  rig.remote.flags = 1;
  rig.remote.follows = false;
  rig.remote.step = 2e-3F;
  ASSERT_TRUE(rig.start());
  rig.periods(100);
  const auto offset = [](const test::MsrBytes& msr) { return test::get<float>(msr, 320); };
  const float before = offset(rig.period());
  rig.period(false);
  EXPECT_NEAR(offset(rig.period()) - before, 4e-3F, 1e-5F);
  EXPECT_NEAR(rig.controller.plant().rate()[0], 0.5, 0.02);
}

TEST(Control, SameSeedAndAnswersAreBitIdentical) {
  const auto run = [](std::uint64_t seed) {
    ControllerConfig config;
    config.seed = seed;
    config.script_pause_s = 0.002;
    sim::OperatorConfig hand = *hand::grip("arm");
    hand.tremor_n = 0.5;
    Motion motion;
    const Pose tool = lwr::LwrArm().tool(config.start_rad);
    motion.path = {tool.position, tool.position + Vec3(0.0, 0.05, 0.0)};
    motion.orientation = tool.orientation;
    Rig rig(config, hand::Hand(hand, motion, kSubstep, seed));
    std::vector<test::MsrBytes> all;
    for (int i = 0; i < 400; ++i)
      all.push_back(rig.period());
    return all;
  };
  const auto first = run(3);
  EXPECT_EQ(first, run(3));
  EXPECT_NE(first, run(4));
}

TEST(Control, ClosedControllerReportsOff) {
  Rig rig(quick());
  ASSERT_TRUE(rig.start());
  test::MsrBytes msr;
  std::memcpy(msr.data(), &rig.controller.close(), msr.size());
  EXPECT_EQ(test::state(msr), 0);
  EXPECT_TRUE(rig.controller.braked());
}

lwr::LwrJoints start(const lwr::LwrArm& arm, const Pose& expected) {
  const lwr::LwrJoints limit = lwr::lwr_limits().position_rad;
  const auto reach = [&arm](const lwr::LwrJoints& q) {
    return arm_sim::Reach{arm.at(q).pose_BT, arm.at(q).jacobian};
  };
  return arm_sim::start_posture(reach, expected, lwr::lwr_rest_posture(), -limit, limit);
}

TEST(StartPosture, PlacesTheToolAtTheMotionsStart) {
  const lwr::LwrArm arm(Pose{Vec3(0.0, 0.0, 0.1), Quat::Identity()});
  const Pose rest = arm.tool(lwr::lwr_rest_posture());
  const Pose expected{rest.position + Vec3(0.05, 0.2, 0.1),
                      rest.orientation * Quat(Eigen::AngleAxisd(0.3, Vec3::UnitX()))};
  const lwr::LwrJoints q = start(arm, expected);
  EXPECT_LT((arm.tool(q).position - expected.position).norm(), 1e-8);
  EXPECT_LT(arm.tool(q).orientation.angularDistance(expected.orientation), 1e-7);
  EXPECT_TRUE((q.cwiseAbs().array() <= lwr::lwr_limits().position_rad.array()).all());
  EXPECT_EQ(start(arm, rest), lwr::lwr_rest_posture());
  EXPECT_THROW(start(arm, {Vec3(2.0, 0.0, 0.0), rest.orientation}), std::runtime_error);
}

}  // namespace
}  // namespace voxtouch::lwr_sim
