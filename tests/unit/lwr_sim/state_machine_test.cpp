#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/unit/lwr_sim/rig.hpp"

namespace voxtouch::lwr_sim {
namespace {

using test::CmdBytes;
using test::MsrBytes;
using test::put;
using test::Rig;

ControllerConfig quick() {
  ControllerConfig config;
  config.script_pause_s = 0.002;
  return config;
}

TEST(StateMachine, CommandModeBeginsOnlyAtQualityPerfect) {
  Rig rig(quick());
  for (int i = 0; i < 19; ++i)
    EXPECT_EQ(test::state(rig.period()), 1);
  EXPECT_EQ(rig.controller.quality(), lwr::fri::Quality::kOk);
  EXPECT_EQ(rig.controller.state(), lwr::fri::State::kMon);
  EXPECT_TRUE(rig.start(10));
  const MsrBytes msr = rig.period();
  EXPECT_EQ(test::state(msr), 2);
  EXPECT_EQ(test::quality(msr), 3);
  EXPECT_EQ(test::control(msr), 3);
}

TEST(StateMachine, WithoutARequestItStaysInMon) {
  Rig rig(quick());
  rig.remote.run = 0;
  const MsrBytes msr = rig.periods(300);
  EXPECT_EQ(test::state(msr), 1);
  EXPECT_EQ(test::echo(msr), 10);
}

TEST(StateMachine, TheProgramEchoesStartAndStop) {
  Rig rig(quick());
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(test::echo(rig.periods(5)), 1);
  rig.remote.run = 0;
  const MsrBytes msr = rig.periods(10);
  EXPECT_EQ(test::state(msr), 1);
  EXPECT_EQ(test::echo(msr), 0);
  EXPECT_EQ(test::error(msr), 0);
  EXPECT_FALSE(rig.controller.braked());
  EXPECT_EQ(rig.controller.drops(), 0u);
  EXPECT_EQ(rig.reason(), Reason::kAsked);
  rig.remote.run = 1;
  EXPECT_TRUE(rig.start());
}

TEST(StateMachine, TheProgramsPauseIsThatOfAPublishedOne) {
  Rig rig;
  rig.remote.run = 0;
  rig.periods(60);
  rig.remote.run = 1;
  int periods = 0;
  while (rig.controller.state() != lwr::fri::State::kCmd && periods < 200)
    rig.period(), ++periods;
  EXPECT_GT(periods, 1);
  EXPECT_LE(periods, 51);
}

TEST(StateMachine, TheFirstStartCanKeepPositionControl) {
  ControllerConfig config = quick();
  config.first_start_keeps_strategy = true;
  Rig rig(config);
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(test::control(rig.period()), 1);
  rig.remote.run = 0;
  rig.periods(10);
  rig.remote.run = 1;
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(test::control(rig.period()), 3);
}

TEST(StateMachine, AChangeOfModeIsNotTakenInCommandMode) {
  Rig rig(quick());
  ASSERT_TRUE(rig.start());
  rig.remote.strategy = 20;
  const MsrBytes msr = rig.periods(50);
  EXPECT_EQ(test::control(msr), 3);
  EXPECT_EQ(test::state(msr), 2);
}

TEST(StateMachine, AnUnknownStrategyIsNotStarted) {
  Rig rig(quick());
  rig.remote.strategy = 31;
  EXPECT_FALSE(rig.start(100));
}

TEST(StateMachine, OneLostAnswerIsBridgedAndFiveEndCommandMode) {
  Rig rig(quick());
  ASSERT_TRUE(rig.start());
  rig.period(false);
  EXPECT_EQ(rig.controller.state(), lwr::fri::State::kCmd);
  EXPECT_EQ(rig.controller.quality(), lwr::fri::Quality::kPerfect);
  rig.periods(50);
  rig.periods(4, false);
  EXPECT_EQ(rig.controller.state(), lwr::fri::State::kCmd);
  rig.period(false);
  EXPECT_EQ(rig.controller.state(), lwr::fri::State::kMon);
  EXPECT_TRUE(rig.controller.braked());
  const MsrBytes msr = rig.period();
  EXPECT_EQ(test::warning(msr), 0x7F);
  EXPECT_EQ(test::error(msr), 0);
  EXPECT_EQ(test::quality(msr), 0);
  EXPECT_EQ(rig.reason(), Reason::kMisses);
  EXPECT_EQ(rig.controller.drops(), 1u);
}

TEST(StateMachine, MoreThanTenOfAHundredMissesEndCommandMode) {
  Rig rig(quick());
  ASSERT_TRUE(rig.start());
  int misses = 0;
  for (; misses < 30 && rig.controller.state() == lwr::fri::State::kCmd; ++misses) {
    rig.period(false);
    rig.periods(5);
  }
  EXPECT_EQ(misses, 11);
}

TEST(StateMachine, EndedCommandModeNeedsAStopFirst) {
  Rig rig(quick());
  ASSERT_TRUE(rig.start());
  rig.periods(5, false);
  EXPECT_FALSE(rig.start(400));
  rig.remote.run = 0;
  rig.periods(10);
  EXPECT_TRUE(rig.controller.braked());
  rig.remote.run = 1;
  EXPECT_TRUE(rig.start());
  EXPECT_FALSE(rig.controller.braked());
}

/// Each violation ends command mode, closes the brakes and leaves error bits until the stop is
/// requested.
void expect_drop(Rig& rig, Reason reason, int bits) {
  EXPECT_EQ(rig.controller.state(), lwr::fri::State::kMon);
  EXPECT_TRUE(rig.controller.braked());
  const MsrBytes msr = rig.period();
  EXPECT_EQ(test::error(msr), bits);
  EXPECT_EQ(rig.reason(), reason);
  rig.tamper = nullptr;
  rig.remote.run = 0;
  EXPECT_EQ(test::error(rig.periods(10)), 0);
}

TEST(StateMachine, AChangeOfFlagsEndsCommandMode) {
  Rig rig(quick());
  ASSERT_TRUE(rig.start());
  rig.periods(3);
  rig.remote.flags = 0x31;
  rig.period();
  expect_drop(rig, Reason::kFlagsChanged, 0x7F);
}

TEST(StateMachine, NonFiniteNumberEndsCommandMode) {
  for (const std::size_t offset : {8u, 144u, 172u, 220u, 248u, 272u, 300u, 328u, 372u}) {
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
      Rig rig(quick());
      ASSERT_TRUE(rig.start());
      rig.tamper = [&](CmdBytes& cmd) { put<float>(cmd, offset, bad); };
      rig.period();
      EXPECT_EQ(rig.controller.counts().not_finite, 1u);
      rig.tamper = nullptr;
      expect_drop(rig, Reason::kNotFinite, 0x7F);
    }
  }
}

TEST(StateMachine, ATorqueOverItsLimitEndsCommandMode) {
  Rig rig(quick());
  ASSERT_TRUE(rig.start());
  rig.remote.torque[4] = static_cast<float>(lwr::lwr_limits().torque_nm[4]) * 1.01F;
  rig.period();
  expect_drop(rig, Reason::kTorque, 1 << 4);
}

TEST(StateMachine, TooFastCommandedPositionEndsCommandMode) {
  Rig rig(quick());
  ASSERT_TRUE(rig.start());
  rig.remote.step = 0.9F * static_cast<float>(lwr::lwr_limits().velocity_rad_s[0]) * 1e-3F;
  rig.remote.follows = false;
  rig.periods(20);
  EXPECT_EQ(rig.controller.state(), lwr::fri::State::kCmd);
  rig.remote.step *= 1.3F;
  rig.period();
  expect_drop(rig, Reason::kCommandSpeed, 1);
}

TEST(StateMachine, AStiffnessOutOfRangeEndsCommandMode) {
  for (const float stiffness : {-1.0F, 2001.0F}) {
    Rig rig(quick());
    ASSERT_TRUE(rig.start());
    rig.remote.joint_stiffness = stiffness;
    rig.period();
    expect_drop(rig, Reason::kGains, 0x7F);
  }
}

TEST(StateMachine, TooFastJointEndsCommandMode) {
  ControllerConfig config = quick();
  config.safety_limits = 0.1;
  Rig rig(config);
  ASSERT_TRUE(rig.start());
  rig.remote.torque[6] = 3.0F;
  int periods = 0;
  while (rig.controller.state() == lwr::fri::State::kCmd && periods < 500)
    rig.period(), ++periods;
  EXPECT_EQ(rig.reason(), Reason::kJointSpeed);
  EXPECT_LT(rig.controller.plant().rate().cwiseAbs().maxCoeff(),
            0.2 * lwr::lwr_limits().velocity_rad_s[6]);
}

TEST(StateMachine, CommandModeWithoutMirroringIsRefused) {
  Rig rig(quick());
  rig.remote.mirror_error = 0.02F;
  EXPECT_FALSE(rig.start(100));
  const MsrBytes msr = rig.period();
  EXPECT_EQ(test::error(msr), 1 << 1);
  EXPECT_EQ(rig.reason(), Reason::kJump);
  rig.remote.mirror_error = 0.0F;
  rig.remote.run = 0;
  EXPECT_EQ(test::error(rig.periods(10)), 0);
  rig.remote.run = 1;
  EXPECT_TRUE(rig.start());
}

TEST(StateMachine, ParsesOnlyAnswersToItsLastMeasurement) {
  Rig rig(quick());
  const auto verdict = [&](auto change) {
    MsrBytes msr;
    std::memcpy(msr.data(), &rig.controller.measure(), msr.size());
    CmdBytes cmd = rig.remote.answer(msr);
    change(cmd);
    const auto result = rig.controller.receive(cmd, 0.0);
    rig.controller.advance();
    return result;
  };
  using Verdict = FriController::Verdict;
  EXPECT_EQ(verdict([](CmdBytes&) {}), Verdict::kAccepted);
  EXPECT_EQ(verdict([](CmdBytes& c) { put<std::uint16_t>(c, 6, 0x2006); }), Verdict::kId);
  EXPECT_EQ(verdict([](CmdBytes& c) { put<std::uint16_t>(c, 4, 375); }), Verdict::kSizeField);
  EXPECT_EQ(verdict([](CmdBytes& c) { put<std::uint16_t>(c, 2, 1); }), Verdict::kStale);
  MsrBytes msr;
  std::memcpy(msr.data(), &rig.controller.measure(), msr.size());
  const CmdBytes cmd = rig.remote.answer(msr);
  EXPECT_EQ(rig.controller.receive(std::span(cmd.data(), 375), 0.0), Verdict::kLength);
  std::array<std::byte, 377> longer{};
  std::memcpy(longer.data(), cmd.data(), cmd.size());
  EXPECT_EQ(rig.controller.receive(longer, 0.0), Verdict::kLength);
  EXPECT_EQ(rig.controller.receive({}, 0.0), Verdict::kLength);
  EXPECT_EQ(rig.controller.receive(cmd, 0.0), Verdict::kAccepted);
  EXPECT_EQ(rig.controller.receive(cmd, 0.0), Verdict::kDoubled);
  const AnswerCounts& c = rig.controller.counts();
  EXPECT_EQ(c.accepted + c.id + c.size_field + c.stale + c.length + c.doubled, 9u);
}

TEST(StateMachine, NewerSecondAnswerReplacesTheFirst) {
  Rig rig(quick());
  ASSERT_TRUE(rig.start());
  rig.periods(20);
  MsrBytes msr;
  std::memcpy(msr.data(), &rig.controller.measure(), msr.size());
  rig.remote.torque[0] = 20.0F;
  const CmdBytes strong = rig.remote.answer(msr);
  rig.remote.torque[0] = 0.0F;
  const CmdBytes back = rig.remote.answer(msr);
  EXPECT_EQ(rig.controller.receive(strong, 0.0), FriController::Verdict::kAccepted);
  EXPECT_EQ(rig.controller.receive(back, 0.0), FriController::Verdict::kReplaced);
  EXPECT_EQ(rig.controller.receive(strong, 0.0), FriController::Verdict::kDoubled);
  rig.controller.advance();
  rig.periods(20);
  EXPECT_LT(rig.controller.row().applied.force.norm(), 1e-3);
}

TEST(StateMachine, EmergencyStopBrakesUntilTheNextStart) {
  Rig rig(quick(), test::arm_at(Vec3(0.1, 0.0, 0.0)), {parse_fault("estop@0.5:0.2", kFaults)});
  ASSERT_TRUE(rig.start());
  while (rig.controller.time_s() < 0.4995)
    rig.period();
  EXPECT_EQ(rig.controller.state(), lwr::fri::State::kCmd);
  MsrBytes msr = rig.period();  // the one at 0.5 s
  EXPECT_EQ(test::state(msr), 1);
  EXPECT_EQ(test::power(msr), 0);
  EXPECT_EQ(test::error(msr), 0);
  EXPECT_EQ(rig.reason(), Reason::kEmergencyStop);
  rig.periods(50);
  EXPECT_EQ(rig.controller.plant().rate(), lwr::LwrJoints::Zero());
  const lwr::LwrJoints stands = rig.controller.plant().q();
  EXPECT_EQ(test::power(rig.periods(120)), 0);
  EXPECT_EQ(test::power(rig.periods(100)), 0x7F);
  EXPECT_EQ(rig.controller.plant().q(), stands);
  rig.remote.run = 0;
  rig.periods(10);
  rig.remote.run = 1;
  EXPECT_TRUE(rig.start());
}

TEST(StateMachine, ReportsWhichDrivesAreOffAndADriveError) {
  Rig off(quick(), test::released_hand(), {parse_fault("drives_off@0.2:0.1:4", kFaults)});
  ASSERT_TRUE(off.start());
  while (off.controller.time_s() < 0.2005)
    off.period();
  EXPECT_EQ(test::power(off.period()), 0x7B);
  EXPECT_EQ(test::error(off.period()), 0);
  EXPECT_EQ(off.controller.state(), lwr::fri::State::kMon);
  EXPECT_EQ(off.reason(), Reason::kDrivesOff);
  Rig error(quick(), test::released_hand(), {parse_fault("drive_error@0.2:0.1:4", kFaults)});
  ASSERT_TRUE(error.start());
  while (error.controller.time_s() < 0.2005)
    error.period();
  EXPECT_EQ(test::error(error.period()), 4);
  EXPECT_EQ(test::error(error.periods(150)), 0);
}

TEST(StateMachine, AForcedQualityShowsAndEndsCommandMode) {
  Rig rig(quick(), test::released_hand(),
          {parse_fault("quality@0.2:0.1:2", kFaults), parse_fault("quality@0.4:0.1:1", kFaults)});
  ASSERT_TRUE(rig.start());
  while (rig.controller.time_s() < 0.2005)
    rig.period();
  EXPECT_EQ(test::quality(rig.period()), 2);
  EXPECT_EQ(rig.controller.state(), lwr::fri::State::kCmd);
  while (rig.controller.time_s() < 0.4015)
    rig.period();
  EXPECT_EQ(test::quality(rig.period()), 1);
  EXPECT_EQ(rig.reason(), Reason::kQualityForced);
  EXPECT_EQ(rig.controller.state(), lwr::fri::State::kMon);
}

TEST(StateMachine, SendsNanMeasurementsOnSchedule) {
  Rig rig(quick(), test::released_hand(),
          {parse_fault("nan@0.1:0.002:3", kFaults), parse_fault("nan@0.2:0.001:8", kFaults)});
  rig.remote.run = 0;
  int bad_joint = 0, bad_time = 0;
  for (int i = 0; i < 300; ++i) {
    const MsrBytes msr = rig.period();
    bad_joint += std::isnan(test::joint(msr, 2));
    bad_time += std::isnan(test::timestamp(msr));
    EXPECT_FALSE(std::isnan(test::joint(msr, 1)));
  }
  EXPECT_EQ(bad_joint, 2);
  EXPECT_EQ(bad_time, 1);
}

TEST(StateMachine, InvalidConfigurationsAreRefused) {
  ControllerConfig config;
  config.period_s = 0.0015;
  EXPECT_THROW(config.validate(), std::runtime_error);
  config.period_s = 0.101;
  EXPECT_THROW(config.validate(), std::runtime_error);
  config = {};
  config.start_rad[0] = 10.0;
  EXPECT_THROW(config.validate(), std::runtime_error);
  config = {};
  config.plant.pose_FT.position[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(config.validate(), std::runtime_error);
  config = {};
  config.torque_noise_nm = -1.0;
  EXPECT_THROW(config.validate(), std::runtime_error);
}

}  // namespace
}  // namespace voxtouch::lwr_sim
