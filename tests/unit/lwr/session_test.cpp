#include <gtest/gtest.h>

#include <set>

#include "devices/lwr/fri_codec.hpp"
#include "devices/lwr/fri_session.hpp"

namespace voxtouch::lwr::fri {
namespace session_test {

constexpr double kDt = 1e-3;
using Phase = FriSession::Phase;

/// A session with the measurement that it sees next.
struct Scene {
  explicit Scene(const SessionRules& rules = {}) : session(rules) {
    msr.interface.state = State::kMon;
    msr.interface.quality = Quality::kPerfect;
    msr.robot.power = kAllDrives;
    msr.robot.control = Control::kJointImpedance;
  }
  Diagnostic update(double seconds = kDt, Diagnostic arm = Diagnostic::kNone) {
    for (double t = 0.0; t < seconds - kDt / 2; t += kDt)
      session.update(msr, kDt, arm);
    return session.diagnostic();
  }
  void command() { msr.interface.state = State::kCmd, msr.krl.integer[kToIntEcho] = kRun; }
  void monitor() { msr.interface.state = State::kMon, msr.krl.integer[kToIntEcho] = kHalt; }
  std::int32_t request() const {
    Krl krl{};
    session.fill(krl);
    return krl.integer[kFrmIntRun];
  }
  void run() {
    update();
    command();
    ASSERT_EQ(update(), Diagnostic::kNone);
  }
  MsrPacket msr = empty_msr();
  FriSession session;
};

TEST(FriSession, StartsAtPerfectQualityOnly) {
  Scene s;
  Krl krl{};
  s.session.fill(krl);
  EXPECT_EQ(krl.integer[kFrmIntStrategy], 30);
  for (const Quality quality :
       {Quality::kInvalid, Quality::kUnacceptable, Quality::kBad, Quality::kOk}) {
    s.msr.interface.quality = quality;
    EXPECT_EQ(s.update(0.1), Diagnostic::kQualityTooLowToStart);
    EXPECT_EQ(s.request(), kHalt);
  }
  s.msr.interface.quality = Quality::kPerfect;
  EXPECT_EQ(s.update(), Diagnostic::kStarting);
  EXPECT_EQ(s.request(), kRun);
  EXPECT_FALSE(s.session.force_allowed());
  s.command();
  EXPECT_EQ(s.update(), Diagnostic::kNone);
  EXPECT_TRUE(s.session.force_allowed());
  EXPECT_EQ(s.session.starts(), 1U);
}

TEST(FriSession, StartsAtTheRequestedQuality) {
  Scene s({.start_quality = Quality::kOk});
  s.msr.interface.quality = Quality::kOk;
  EXPECT_EQ(s.update(), Diagnostic::kStarting);
}

TEST(FriSession, HaltsAProgramOfAnEarlierSession) {
  Scene s;
  s.command();
  EXPECT_EQ(s.update(0.1), Diagnostic::kProgramStillRuns);
  EXPECT_EQ(s.request(), kHalt);
  EXPECT_FALSE(s.session.force_allowed()) << "command mode, but not the one that was asked for";
  s.msr.interface.state = State::kMon;
  EXPECT_EQ(s.update(), Diagnostic::kProgramStillRuns) << "the echo says that it has not received";
  s.monitor();
  EXPECT_EQ(s.update(), Diagnostic::kStarting);
}

TEST(FriSession, RetriesAFailedStart) {
  Scene s({.start_timeout_s = 0.1, .pause_s = 0.05});
  EXPECT_EQ(s.update(0.09), Diagnostic::kStarting);
  EXPECT_EQ(s.update(0.02), Diagnostic::kStartTimedOut);
  EXPECT_EQ(s.request(), kHalt);
  EXPECT_EQ(s.update(0.06), Diagnostic::kStarting);
  EXPECT_EQ(s.request(), kRun);
}

TEST(FriSession, RecoversAfterLeavingCommandMode) {
  Scene s({.pause_s = 0.05});
  s.run();
  s.monitor();
  EXPECT_EQ(s.update(), Diagnostic::kDroppedOut);
  EXPECT_EQ(s.session.error(), devices::DeviceError::kRecoverable);
  EXPECT_EQ(s.request(), kHalt) << "asked to halt before it is asked to start";
  EXPECT_EQ(s.update(0.04), Diagnostic::kDroppedOut);
  EXPECT_EQ(s.update(0.02), Diagnostic::kStarting);
  s.command();
  EXPECT_EQ(s.update(), Diagnostic::kNone);
  EXPECT_EQ(s.session.drops(), 1U);
  EXPECT_EQ(s.session.starts(), 2U);
}

TEST(FriSession, RequestsAnOperatorAfterTooManyDrops) {
  Scene s({.pause_s = 0.0, .max_drops = 3});
  for (int n = 0; n < 3; ++n) {
    ASSERT_NE(s.session.error(), devices::DeviceError::kFault);
    s.run();
    s.monitor();
    s.update();
  }
  EXPECT_EQ(s.update(1.0), Diagnostic::kTooManyDrops);
  EXPECT_EQ(s.session.error(), devices::DeviceError::kFault);
  EXPECT_EQ(s.request(), kHalt);
}

TEST(FriSession, SuspendsTheForceForLowQuality) {
  Scene s;
  s.run();
  s.msr.interface.quality = Quality::kBad;
  EXPECT_EQ(s.update(), Diagnostic::kQualityDropped);
  EXPECT_EQ(s.session.error(), devices::DeviceError::kRecoverable);
  EXPECT_EQ(s.request(), kRun) << "command mode is kept";
  s.msr.interface.quality = Quality::kInvalid;
  EXPECT_EQ(s.update(), Diagnostic::kQualityDropped);
  s.msr.interface.quality = Quality::kOk;
  EXPECT_EQ(s.update(), Diagnostic::kNone);
}

TEST(FriSession, DistinguishesDrivesNotOnFromDrivesOff) {
  Scene s({.pause_s = 0.0, .drives_off_grace_s = 0.5});
  s.msr.robot.power = 0x3F;
  EXPECT_EQ(s.update(10.0), Diagnostic::kDrivesNotOn);
  EXPECT_EQ(s.session.error(), devices::DeviceError::kRecoverable)
      << "a person has not switched them on yet";
  s.msr.robot.power = kAllDrives;
  s.run();
  s.msr.robot.power = 0;
  EXPECT_EQ(s.update(), Diagnostic::kDrivesWentOff);
  EXPECT_FALSE(s.session.in_command())
      << "drives off: the position must mirror, whatever the state says";
  EXPECT_EQ(s.session.error(), devices::DeviceError::kRecoverable);
  s.update(0.6);
  EXPECT_EQ(s.session.error(), devices::DeviceError::kFault);
}

TEST(FriSession, DriveErrorIsAFaultAtOnce) {
  Scene s;
  s.run();
  s.msr.robot.error = 0x04;
  EXPECT_EQ(s.update(), Diagnostic::kDriveError);
  EXPECT_EQ(s.session.error(), devices::DeviceError::kFault);
}

TEST(FriSession, ClosedInterfaceIsADisconnection) {
  for (const State state : {State::kOff, State::kInvalid}) {
    Scene s;
    s.run();
    s.msr.interface.state = state;
    EXPECT_EQ(s.update(), Diagnostic::kClosed);
    EXPECT_EQ(s.session.error(), devices::DeviceError::kDisconnected);
    EXPECT_FALSE(s.session.in_command());
  }
}

TEST(FriSession, RefusesAnotherControlMode) {
  Scene s;
  s.update();
  s.command();
  s.msr.robot.control = Control::kPosition;
  EXPECT_EQ(s.update(), Diagnostic::kWrongControlMode);
  EXPECT_EQ(s.request(), kHalt);
  Scene t;
  t.run();
  t.msr.robot.control = Control::kCartesianImpedance;
  EXPECT_EQ(t.update(), Diagnostic::kWrongControlMode);
  EXPECT_FALSE(t.session.force_allowed());
}

TEST(FriSession, SuspendsTheForceForATooFastJoint) {
  Scene s;
  s.run();
  EXPECT_EQ(s.update(kDt, Diagnostic::kTooFast), Diagnostic::kTooFast);
  EXPECT_EQ(s.session.error(), devices::DeviceError::kRecoverable);
  EXPECT_EQ(s.update(), Diagnostic::kNone);
}

TEST(FriSession, StopIsFinal) {
  Scene s;
  s.run();
  s.session.request_stop();
  EXPECT_EQ(s.request(), kHalt);
  EXPECT_FALSE(s.session.force_allowed());
  EXPECT_FALSE(s.session.stopped());
  s.update();
  EXPECT_FALSE(s.session.stopped());
  s.monitor();
  s.update();
  EXPECT_TRUE(s.session.stopped());
  s.update(1.0);
  EXPECT_EQ(s.request(), kHalt);
}

TEST(FriSession, HasASentenceForEveryDiagnostic) {
  std::set<std::string_view> sentences;
  for (int n = 0; n <= static_cast<int>(Diagnostic::kStopping); ++n)
    sentences.insert(sentence_of(static_cast<Diagnostic>(n)));
  EXPECT_EQ(sentences.size(), static_cast<std::size_t>(Diagnostic::kStopping) + 1);
  EXPECT_EQ(sentences.count("unknown"), 0U);
}

}  // namespace session_test
}  // namespace voxtouch::lwr::fri
