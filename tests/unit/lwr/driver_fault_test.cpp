// Each fault removes the push in the very next answer.
#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "fake_controller.hpp"

namespace voxtouch::test {
namespace {

using namespace std::chrono_literals;

const Wrench kPush{Vec3(5, -3, 8), Vec3(0.4, -0.2, 0.1)};
const double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A driver with a push.
class LwrDriverFault : public testing::Test {
 protected:
  void SetUp() override { run(quick_options()); }
  void run(const lwr::LwrOptions& options) {
    driver.reset();
    krc = std::make_unique<FakeController>();
    driver = krc->open(options);
    ASSERT_TRUE(run_to_command(*krc, *driver));
    push();
  }
  void push() { ASSERT_GT(torque_of(cycle(*krc, *driver, kPush).command), 1.0); }
  /// One cycle with a requested push; the answer must contain none.
  Cycle without_push(const Wrench& wrench = kPush) {
    const Cycle t = cycle(*krc, *driver, wrench);
    EXPECT_EQ(t.answers, 1U);
    EXPECT_EQ(torque_of(t.command), 0.0);
    return t;
  }
  lwr::fri::MsrPacket& msr() { return krc->msr; }

  std::unique_ptr<FakeController> krc;
  std::unique_ptr<lwr::LwrDriver> driver;
};

TEST_F(LwrDriverFault, RefusesANonFiniteCommand) {
  for (int axis = 0; axis < 6; ++axis)
    for (const double bad : {kNaN, std::numeric_limits<double>::infinity()}) {
      Wrench wrench = kPush;
      (axis < 3 ? wrench.force : wrench.torque)[axis % 3] = bad;
      EXPECT_EQ(without_push(wrench).written.error(), devices::DeviceError::kNotFinite);
      push();
    }
}

TEST_F(LwrDriverFault, RefusesACommandOverTheLimits) {
  EXPECT_EQ(without_push({Vec3(0, 0, 150.1), Vec3::Zero()}).written.error(),
            devices::DeviceError::kLimit);
  push();
  EXPECT_EQ(without_push({Vec3::Zero(), Vec3(15.1, 0, 0)}).written.error(),
            devices::DeviceError::kLimit);
  EXPECT_EQ(driver->counts().refused, 2U);
  push();
}

TEST_F(LwrDriverFault, FlagsAPoseFromInvalidJoints) {
  const float good = msr().data.jnt_pos[2];
  const Pose before = cycle(*krc, *driver).sample->pose;
  for (const float bad : {static_cast<float>(kNaN), INFINITY, 3.2F}) {
    msr().data.jnt_pos[2] = bad;
    const Cycle t = without_push();
    ASSERT_TRUE(t.sample);
    EXPECT_FALSE(t.sample->pose_valid);
    EXPECT_TRUE(t.sample->pose.finite());
    EXPECT_TRUE(t.sample->twist.finite());
    EXPECT_EQ(t.sample->pose.position, before.position) << "the last one that was good";
    EXPECT_EQ(t.written.error(), devices::DeviceError::kProtocol);
    EXPECT_LT(std::abs(t.command.command.jnt_pos[2] - good), 1e-6) << "finite, and where it was";
  }
  msr().data.jnt_pos[2] = good;
  push();
  EXPECT_EQ(driver->counts().invalid_poses, 3U);
}

TEST_F(LwrDriverFault, AnswersInvalidMeasurementsWithTheLastPosition) {
  const float kept = krc->received.back().command.jnt_pos[4];
  const lwr::fri::MsrPacket good = msr();
  msr().data.cmd_jnt_pos[4] = static_cast<float>(kNaN);
  Cycle t = without_push();
  EXPECT_EQ(t.sample.error(), devices::DeviceError::kProtocol);
  EXPECT_EQ(t.command.command.jnt_pos[4], kept);
  EXPECT_EQ(t.command.header.refl_seq, msr().header.send_seq);
  msr().data.cmd_jnt_pos[4] = good.data.cmd_jnt_pos[4];
  push();
  msr().interface.quality = static_cast<lwr::fri::Quality>(7);
  EXPECT_EQ(without_push().sample.error(), devices::DeviceError::kProtocol);
  msr().interface.quality = lwr::fri::Quality::kPerfect;
  push();
  EXPECT_EQ(driver->counts().invalid, 2U);
}

TEST_F(LwrDriverFault, ReportsAProtocolErrorForGarbage) {
  const std::array<std::byte, 916> garbage{};
  krc->send_bytes(garbage);
  krc->send_bytes(std::span(garbage).first(10));
  EXPECT_EQ(driver->read(2ms).error(), devices::DeviceError::kProtocol);
  EXPECT_EQ(driver->counts().malformed, 2U);
  EXPECT_EQ(driver->read(2ms).error(), devices::DeviceError::kTimeout);
  push();
}

TEST_F(LwrDriverFault, TimesOutThenDisconnectsAfterSilence) {
  EXPECT_EQ(driver->read(1ms).error(), devices::DeviceError::kTimeout);
  EXPECT_EQ(driver->write(kPush).error(), devices::DeviceError::kTimeout);
  EXPECT_TRUE(krc->receive().empty());
  driver->stop();
  const auto answers = krc->receive();
  ASSERT_EQ(answers.size(), 1U) << "what the loop does after an error";
  EXPECT_EQ(torque_of(answers[0]), 0.0);
  push();
  lwr::LwrOptions options = quick_options();
  options.silence_s = 0.03;
  run(options);
  EXPECT_EQ(driver->read(10ms).error(), devices::DeviceError::kTimeout);
  EXPECT_EQ(driver->read(40ms).error(), devices::DeviceError::kDisconnected);
}

TEST_F(LwrDriverFault, IgnoresDuplicatesAndOldPackets) {
  const lwr::fri::MsrPacket old = krc->next();
  push();
  krc->send(old);
  EXPECT_EQ(driver->read(1ms).error(), devices::DeviceError::kTimeout);
  krc->send(msr());  // the newest once more
  EXPECT_EQ(driver->read(1ms).error(), devices::DeviceError::kTimeout);
  EXPECT_TRUE(krc->receive().empty());
  EXPECT_EQ(driver->sequence().reordered, 1U);
  EXPECT_EQ(driver->sequence().duplicates, 1U);
  EXPECT_EQ(driver->sequence().lost, 1U);
}

TEST_F(LwrDriverFault, TakesTheNewestInAnyOrder) {
  const lwr::fri::MsrPacket first = krc->next(), second = krc->next(), third = krc->next();
  const auto before =
      driver->counts()
          .superseded;  // while it opened, several may have arrived together on a busy machine
  krc->send(first);
  krc->send(third);
  krc->send(second);
  const auto sample = driver->read(10ms);
  ASSERT_TRUE(sample);
  ASSERT_TRUE(driver->write(kPush));
  const auto answers = krc->receive();
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].header.refl_seq, third.header.send_seq);
  EXPECT_EQ(driver->counts().superseded - before, 1U);
}

TEST_F(LwrDriverFault, CountsLostPacketsAcrossTheWrap) {
  msr().header.send_seq = 65500;
  for (int n = 0; n < 20; ++n)
    cycle(*krc, *driver);  // the driver takes the jump for a controller that counts anew
  const auto before = driver->sequence().lost;
  for (int n = 0; n < 20; ++n) {
    (void)krc->next();  // every second one is lost
    ASSERT_TRUE(cycle(*krc, *driver).written);
  }
  EXPECT_EQ(driver->sequence().lost - before, 20U);
}

TEST_F(LwrDriverFault, IgnoresAStaleMeasurement) {
  lwr::LwrOptions options = quick_options();
  options.max_age_s = 0.1;
  run(options);
  krc->send();
  std::this_thread::sleep_for(120ms);
  EXPECT_EQ(driver->read(1ms).error(), devices::DeviceError::kTimeout);
  EXPECT_EQ(driver->counts().stale, 1U);
  push();
}

TEST_F(LwrDriverFault, UnansweredMeasurementsGetZeroForce) {
  krc->send();
  ASSERT_TRUE(driver->read(10ms));
  krc->send();
  ASSERT_TRUE(driver->read(10ms));
  const auto answers = krc->receive();
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(torque_of(answers[0]), 0.0);
  EXPECT_EQ(driver->counts().unread_answers, 1U);
  EXPECT_TRUE(driver->write(kPush));
}

TEST_F(LwrDriverFault, AcceptsOnlyItsOwnController) {
  FakeController unauthorised("127.0.0.2");
  unauthorised.port = krc->port;
  unauthorised.msr = msr();
  unauthorised.msr.header.send_seq = static_cast<std::uint16_t>(msr().header.send_seq + 1);
  unauthorised.send();
  EXPECT_EQ(driver->read(1ms).error(), devices::DeviceError::kTimeout);
  EXPECT_TRUE(unauthorised.receive().empty());
  EXPECT_EQ(driver->counts().foreign, 1U);
}

TEST_F(LwrDriverFault, SuspendsTheForceForLowQuality) {
  msr().interface.quality = lwr::fri::Quality::kBad;
  const Cycle t = without_push();
  EXPECT_TRUE(t.sample);
  EXPECT_EQ(t.written.error(), devices::DeviceError::kRecoverable);
  EXPECT_EQ(t.command.krl.integer[lwr::fri::kFrmIntRun], lwr::fri::kRun);
  EXPECT_EQ(driver->session().diagnostic(), lwr::fri::Diagnostic::kQualityDropped);
  msr().interface.quality = lwr::fri::Quality::kOk;
  push();
}

TEST_F(LwrDriverFault, RecoversAfterTheControllerLeftCommandMode) {
  krc->program_runs = false;
  msr().interface.state = lwr::fri::State::kMon;
  msr().krl.integer[lwr::fri::kToIntEcho] = lwr::fri::kHalt;
  msr().data.cmd_jnt_pos[0] = 0.3F;
  const Cycle t = without_push();
  EXPECT_EQ(t.written.error(), devices::DeviceError::kRecoverable);
  EXPECT_EQ(t.command.command.jnt_pos[0], 0.3F) << "mirrors again at once";
  EXPECT_EQ(t.command.krl.integer[lwr::fri::kFrmIntRun], lwr::fri::kHalt);
  EXPECT_EQ(driver->session().diagnostic(), lwr::fri::Diagnostic::kDroppedOut);
  krc->program_runs = true;
  ASSERT_TRUE(run_to_command(*krc, *driver));
  EXPECT_EQ(driver->session().starts(), 2U);
  EXPECT_EQ(driver->session().drops(), 1U);
  push();
}

TEST_F(LwrDriverFault, ReportsWhichDrivesWentOff) {
  msr().robot.power = 0x7B;
  msr().interface.state = lwr::fri::State::kMon;
  krc->program_runs = false;
  EXPECT_EQ(without_push().written.error(), devices::DeviceError::kRecoverable);
  EXPECT_EQ(driver->session().diagnostic(), lwr::fri::Diagnostic::kDrivesWentOff);
  EXPECT_NE(driver->status_text().find("[drives off: E1]"), std::string::npos)
      << driver->status_text();
}

TEST_F(LwrDriverFault, DriveErrorIsAFault) {
  msr().robot.error = 0x41;
  const Cycle t = without_push();
  EXPECT_EQ(t.sample.error(), devices::DeviceError::kFault);
  EXPECT_NE(driver->status_text().find("[errors of A1 A6]"), std::string::npos)
      << driver->status_text();
}

TEST_F(LwrDriverFault, ClosedInterfaceIsADisconnection) {
  msr().interface.state = lwr::fri::State::kOff;
  krc->program_runs = false;
  EXPECT_EQ(without_push().sample.error(), devices::DeviceError::kDisconnected);
}

TEST_F(LwrDriverFault, DropsTheForceWhileAJointIsTooFast) {
  bool refused = false;
  for (int n = 0; n < 40 && !refused; ++n) {
    msr().data.jnt_pos[0] += 0.004F;  // 4 rad/s; the limit is 1.9
    const Cycle t = cycle(*krc, *driver, kPush);
    refused = t.sample && !t.written;
    if (refused) {
      EXPECT_EQ(torque_of(t.command), 0.0);
    }
  }
  EXPECT_TRUE(refused);
  EXPECT_EQ(driver->session().diagnostic(), lwr::fri::Diagnostic::kTooFast);
  for (int n = 0; n < 40; ++n)
    cycle(*krc, *driver, kPush);
  push();
}

TEST_F(LwrDriverFault, NeverSendsANonFiniteNumber) {
  std::uint32_t random = 1;
  const lwr::fri::MsrPacket good = msr();
  krc->program_runs = false;
  for (int n = 0; n < 3000; ++n) {
    random = random * 1664525U + 1013904223U;
    const std::uint16_t sequence = msr().header.send_seq;
    msr() = good;
    msr().header.send_seq = sequence;
    const std::size_t word = 2 + random / 65536U % 227U;  // any word but the head's
    const std::uint32_t bits = n % 3 ? random * 747796405U : 0x7FC00000U;
    std::memcpy(reinterpret_cast<char*>(&msr()) + 4 * word, &bits, 4);
    const std::size_t before = krc->received.size();
    const Cycle t = cycle(*krc, *driver, kPush);
    EXPECT_EQ(krc->received.size(), before + 1)
        << "answered, and the fake refuses what is not finite; word " << word;
    if (t.sample) {
      EXPECT_TRUE(t.sample->pose.finite() && t.sample->twist.finite());
    }
    EXPECT_LE(torque_of(krc->received.back()), 100.0);
  }
}

}  // namespace
}  // namespace voxtouch::test
