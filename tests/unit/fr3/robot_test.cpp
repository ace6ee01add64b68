// Tests the test double: the simulated robot refuses and stops under the documented conditions of
// the real one.
#include <gtest/gtest.h>

#include "devices/fr3/simulated/fci_robot.hpp"

namespace voxtouch::fr3_sim {
namespace robot_test {

using fr3::fci::Outcome;
using fr3::fci::Request;
using fr3::fci::RobotMode;

hand::Hand released_hand() {
  sim::OperatorConfig config;
  config.released = true;
  Motion rest;
  rest.path = {Vec3::Zero()};
  return hand::Hand(config, rest, kSubstep);
}

struct Rig {
  explicit Rig(std::vector<Fault> faults = {})
      : robot(RobotConfig{}, released_hand(), FaultSchedule(std::move(faults))) {}
  Outcome move() {
    fr3::fci::Received body;
    const fr3::fci::Message message = fr3::fci::move_request(robot.dialect(), 1);
    std::copy(message.bytes.begin() + 12, message.bytes.begin() + 68, body.body.begin());
    return robot.request(Request::kMove, body);
  }
  /// One millisecond, answered with `torque` unless absent.
  fr3::fci::State period(const std::optional<arm::Joints>& torque, bool finished = false) {
    const fr3::fci::State state = robot.measure();
    if (torque) {
      std::array<std::byte, fr3::fci::kMaxCommandBytes> bytes;
      const std::size_t size =
          fr3::fci::encode(robot.dialect(), {state.message_id, *torque, finished}, bytes);
      robot.receive(std::span(bytes).first(size));
    }
    robot.advance();
    return state;
  }
  FciRobot robot;
};

const arm::Joints kZero = arm::Joints::Zero();

TEST(Faults, AreThoseOfThisRobot) {
  EXPECT_EQ(parse_fault("reflex@1", kFaults).value, 7.0);
  EXPECT_THROW(parse_fault("estop@1", kFaults), std::runtime_error);
  EXPECT_EQ(parse_fault("nan@1:1:7", kFaults).value, 7.0);
  EXPECT_THROW(parse_fault("nan@1:1:8", kFaults), std::runtime_error);
}

TEST(FciRobot, HoldsTheArmStillWithoutAMotionAndFloatsInOne) {
  Rig rig;
  for (int i = 0; i < 100; ++i)
    rig.period(std::nullopt);
  EXPECT_EQ(rig.robot.plant().q(), fr3::fr3_rest_posture());
  EXPECT_EQ(rig.move(), Outcome::kStarted);
  for (int i = 0; i < 100; ++i)
    rig.period(kZero);
  EXPECT_EQ(rig.robot.plant().q(), fr3::fr3_rest_posture()) << "gravity is its own matter";
  EXPECT_EQ(rig.robot.mode(), RobotMode::kMove);
  EXPECT_EQ(rig.robot.measure().success_rate, 1.0);
}

TEST(FciRobot, ToleratesNineteenLostCommandsNotTwenty) {
  Rig rig;
  rig.move();
  rig.period(kZero);
  for (int i = 0; i < 19; ++i)
    rig.period(std::nullopt);
  EXPECT_EQ(rig.robot.mode(), RobotMode::kMove);
  rig.period(kZero);
  for (int i = 0; i < 20; ++i)
    rig.period(std::nullopt);
  EXPECT_EQ(rig.robot.mode(), RobotMode::kReflex);
  EXPECT_EQ(rig.robot.measure().errors, fr3::fci::kLostPacketsError);
  EXPECT_EQ(rig.robot.motion_ended(), Outcome::kReflex);
  EXPECT_EQ(rig.move(), Outcome::kNotPossible) << "before it is recovered";
  EXPECT_EQ(rig.robot.request(Request::kErrorRecovery, {}), Outcome::kSuccess);
  EXPECT_EQ(rig.move(), Outcome::kStarted);
}

TEST(FciRobot, StopsForTorqueJumpsButNotForSteps) {
  Rig rig;
  rig.move();
  arm::Joints torque = kZero;
  for (int i = 0; i < 5; ++i)
    rig.period(torque += 0.99 * arm::Joints::Unit(1));
  EXPECT_EQ(rig.robot.mode(), RobotMode::kMove);
  rig.period(torque + 1.1 * arm::Joints::Unit(3));
  EXPECT_EQ(rig.robot.measure().errors, fr3::fci::kTorqueJumpError);
}

TEST(FciRobot, TakesACommandForItsOwnMillisecondOnly) {
  Rig rig;
  rig.move();
  rig.period(kZero);
  const fr3::fci::State old = rig.robot.measure();
  rig.robot.advance();
  rig.robot.measure();
  std::array<std::byte, fr3::fci::kMaxCommandBytes> bytes;
  const std::size_t size =
      fr3::fci::encode(rig.robot.dialect(), {old.message_id, kZero, false}, bytes);
  rig.robot.receive(std::span(bytes).first(size));
  EXPECT_EQ(rig.robot.counts().stale, 1U);
}

TEST(FciRobot, EndsAMotionByCommandOrByChannel) {
  Rig rig;
  rig.move();
  rig.period(kZero);
  rig.period(kZero, true);
  EXPECT_EQ(rig.robot.mode(), RobotMode::kIdle);
  EXPECT_EQ(rig.robot.motion_ended(), Outcome::kSuccess);
  rig.move();
  rig.period(kZero);
  EXPECT_EQ(rig.robot.request(Request::kStopMove, {}), Outcome::kSuccess);
  EXPECT_EQ(rig.robot.motion_ended(), Outcome::kPreempted);
}

TEST(FciRobot, AUserStopIsAStopAndRefusesAMotion) {
  Rig rig({parse_fault("user_stop@0.01:0.01", kFaults)});
  rig.move();
  for (int i = 0; i < 12; ++i)
    rig.period(kZero);
  EXPECT_EQ(rig.robot.mode(), RobotMode::kUserStopped);
  EXPECT_EQ(rig.robot.motion_ended(), Outcome::kEmergency);
  EXPECT_EQ(rig.move(), Outcome::kEmergency);
  for (int i = 0; i < 10; ++i)
    rig.period(std::nullopt);
  EXPECT_EQ(rig.move(), Outcome::kStarted);
}

}  // namespace robot_test
}  // namespace voxtouch::fr3_sim
