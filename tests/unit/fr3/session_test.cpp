#include "devices/fr3/fci_session.hpp"

#include <gtest/gtest.h>

namespace voxtouch::fr3::fci {
namespace session_test {

State in_mode(RobotMode mode) {
  State state;
  state.mode = mode;
  return state;
}
State in_torque_control() {
  State state = in_mode(RobotMode::kMove);
  state.controller = ControllerMode::kExternal;
  state.generator_mode = dialect_of(10)->generator_mode;
  return state;
}
State in_reflex(Errors errors) {
  State state = in_mode(RobotMode::kReflex);
  state.errors = state.reflex = errors;
  return state;
}

struct Rig {
  FciSession session{*dialect_of(10)};
  /// Passes `state` for `seconds`; returns the request made meanwhile.
  std::optional<Request> update(const State& state, double seconds = 1e-3) {
    std::optional<Request> asked;
    for (double t = 0.0; t < seconds - 1e-9; t += 1e-3) {
      session.update(state, 1e-3, false);
      if (const auto due = session.due())
        asked = due;
    }
    return asked;
  }
  void run() {
    EXPECT_EQ(update(in_mode(RobotMode::kIdle)), Request::kMove);
    session.answered(Request::kMove, Outcome::kStarted);
    EXPECT_EQ(update(in_torque_control()), std::nullopt);
    EXPECT_TRUE(session.force_allowed());
  }
};

TEST(FciSession, RequestsTorqueControlOnceThenAllowsForce) {
  Rig rig;
  EXPECT_FALSE(rig.session.force_allowed());
  rig.run();
  EXPECT_EQ(rig.session.diagnostic(), Diagnostic::kNone);
}

TEST(FciSession, RecoversFromLostPacketsALimitedNumberOfTimes) {
  Rig rig;
  rig.run();
  for (int n = 0; n < 10; ++n) {
    EXPECT_EQ(rig.update(in_reflex(kLostPacketsError)), std::nullopt);
    EXPECT_FALSE(rig.session.force_allowed());
    EXPECT_EQ(rig.session.diagnostic(), Diagnostic::kLostPackets);
    EXPECT_EQ(rig.update(in_reflex(kLostPacketsError), 0.4), std::nullopt) << "not at once";
    EXPECT_EQ(rig.update(in_reflex(kLostPacketsError), 0.2), Request::kErrorRecovery);
    rig.session.answered(Request::kErrorRecovery, Outcome::kSuccess);
    EXPECT_EQ(rig.update(in_mode(RobotMode::kIdle), 0.6), Request::kMove);
    rig.update(in_torque_control());
    EXPECT_TRUE(rig.session.force_allowed());
  }
  rig.update(in_reflex(kLostPacketsError), 2.0);
  EXPECT_EQ(rig.session.error(), devices::DeviceError::kFault);
  EXPECT_EQ(rig.session.diagnostic(), Diagnostic::kTooOften);
}

TEST(FciSession, OtherReflexesNeedAnOperator) {
  for (const Errors errors : {Errors{1} << 7, kLostPacketsError | Errors{1} << 3, Errors{0}}) {
    Rig rig;
    rig.run();
    EXPECT_EQ(rig.update(in_reflex(errors), 3.0), std::nullopt);
    EXPECT_EQ(rig.session.error(), devices::DeviceError::kFault);
    EXPECT_EQ(rig.session.diagnostic(), Diagnostic::kReflex);
    EXPECT_EQ(rig.session.errors(), errors);
  }
}

TEST(FciSession, WaitsThroughAShortUserStopAndEndsInALongOne) {
  Rig rig;
  rig.run();
  EXPECT_EQ(rig.update(in_mode(RobotMode::kUserStopped), 1.0), std::nullopt);
  EXPECT_EQ(rig.session.diagnostic(), Diagnostic::kUserStop);
  EXPECT_EQ(rig.session.error(), devices::DeviceError::kRecoverable);
  EXPECT_EQ(rig.update(in_mode(RobotMode::kIdle), 0.6), Request::kMove);
  rig.update(in_torque_control());
  EXPECT_TRUE(rig.session.force_allowed());
  rig.update(in_mode(RobotMode::kUserStopped), 2.1);
  EXPECT_EQ(rig.session.error(), devices::DeviceError::kFault);
}

TEST(FciSession, ReportsARefusedMoveAndRetries) {
  Rig rig;
  EXPECT_EQ(rig.update(in_mode(RobotMode::kIdle)), Request::kMove);
  rig.session.answered(Request::kMove, Outcome::kSafetyFunction);
  EXPECT_EQ(rig.session.diagnostic(), Diagnostic::kRefused);
  EXPECT_EQ(rig.session.refusal(), Outcome::kSafetyFunction);
  EXPECT_EQ(rig.update(in_mode(RobotMode::kIdle), 0.6), Request::kMove);
  for (int n = 0; n < 10; ++n) {
    rig.session.answered(Request::kMove, Outcome::kSafetyFunction);
    rig.update(in_mode(RobotMode::kIdle), 0.6);
  }
  EXPECT_EQ(rig.session.error(), devices::DeviceError::kFault);
}

TEST(FciSession, AnotherProgramsMotionIsNotItsOwn) {
  Rig rig;
  EXPECT_EQ(rig.update(in_torque_control(), 1.0), std::nullopt);
  EXPECT_FALSE(rig.session.force_allowed());
}

TEST(FciSession, TooFastJointSuspendsTheForce) {
  Rig rig;
  rig.run();
  rig.session.update(in_torque_control(), 1e-3, true);
  EXPECT_FALSE(rig.session.force_allowed());
  EXPECT_EQ(rig.session.diagnostic(), Diagnostic::kFast);
  rig.update(in_torque_control());
  EXPECT_TRUE(rig.session.force_allowed());
}

TEST(FciSession, EndStopsTheMotionAndRequestsNothingElse) {
  Rig rig;
  rig.run();
  rig.session.end();
  EXPECT_EQ(rig.session.due(), Request::kStopMove);
  EXPECT_FALSE(rig.session.force_allowed());
  EXPECT_EQ(rig.update(in_mode(RobotMode::kIdle), 2.0), std::nullopt);
}

TEST(FciSession, EveryDiagnosticHasASentenceWithARemedy) {
  for (int i = 1; i <= static_cast<int>(Diagnostic::kFast); ++i)
    EXPECT_TRUE(sentence_of(static_cast<Diagnostic>(i)).starts_with("no force")) << i;
}

}  // namespace session_test
}  // namespace voxtouch::fr3::fci
