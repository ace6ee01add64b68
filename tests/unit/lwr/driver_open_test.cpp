// Opening: messages if it fails, and that it can be repeated.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "fake_controller.hpp"

namespace voxtouch::test {
namespace {

using namespace std::chrono_literals;

/// Message of a failed opening; empty if it succeeds.
std::string refusal(const lwr::LwrOptions& options) {
  try {
    lwr::LwrDriver driver(options);
  } catch (const devices::DeviceOpenError& error) {
    return error.what();
  }
  return {};
}
bool states(const std::string& sentence, std::string_view fact) { return sentence.contains(fact); }

TEST(LwrOpen, ReportsThatNothingCameAndWhatToCheck) {
  lwr::LwrOptions options = quick_options();
  options.connect_timeout_s = 0.02;
  const std::string sentence = refusal(options);
  for (const std::string& part :
       {std::string("0.02 s"), "127.0.0.1:" + std::to_string(options.port), std::string("friOpen"),
        std::string("friSetup")})
    EXPECT_TRUE(states(sentence, part)) << part << " is not in: " << sentence;
}

TEST(LwrOpen, IsCancelledFromAnotherThread) {
  lwr::LwrOptions options = quick_options();
  options.connect_timeout_s = 3600.0;
  std::atomic<bool> cancelled{false};
  options.cancelled = &cancelled;
  std::jthread other([&] { cancelled.store(true); });
  EXPECT_FALSE(states(refusal(options), "3600")) << "it did not wait so long";
}

TEST(LwrOpen, ReportsThatThePortIsBusy) {
  FakeController krc;
  const auto driver = krc.open();
  lwr::LwrOptions options = quick_options();
  options.port = krc.port;
  const std::string sentence = refusal(options);
  EXPECT_TRUE(states(sentence, "127.0.0.1:" + std::to_string(krc.port))) << sentence;
  EXPECT_TRUE(cycle(krc, *driver).sample) << "the one that was first goes on";
}

TEST(LwrOpen, ReportsAnInvalidOrForeignAddress) {
  lwr::LwrOptions options = quick_options();
  options.address = "robot";
  EXPECT_TRUE(states(refusal(options), "'robot'"));
  options.address = "203.0.113.7";
  EXPECT_TRUE(states(refusal(options), "203.0.113.7"));
}

TEST(LwrOpen, ReportsWhatCameInsteadOfAMeasurement) {
  FakeController krc;
  lwr::LwrOptions options = quick_options();
  options.connect_timeout_s = 0.05;
  krc.port = options.port;
  std::string sentence;
  krc.msr.header.datagram_id = 0x2007;
  krc.serve_while([&] { sentence = refusal(options); });
  EXPECT_TRUE(states(sentence, "916 bytes from 127.0.0.1:") &&
              states(sentence, name_of(lwr::fri::PacketFault::kId)))
      << sentence;
  krc.msr.header.datagram_id = lwr::fri::kMsrId;
  krc.msr.data.cmd_jnt_pos[0] = std::numeric_limits<float>::quiet_NaN();
  krc.serve_while([&] { sentence = refusal(options); });
  EXPECT_TRUE(states(sentence, name_of(lwr::fri::PacketFault::kNotFinite)) &&
              !states(sentence, "bytes"))
      << sentence;
}

TEST(LwrOpen, ReportsThatTheInterfaceIsClosed) {
  FakeController krc;
  krc.program_runs = false;
  lwr::LwrOptions options = quick_options();
  options.connect_timeout_s = 0.05;
  krc.port = options.port;
  krc.msr.interface.state = lwr::fri::State::kOff;
  std::string sentence;
  krc.serve_while([&] { sentence = refusal(options); });
  EXPECT_TRUE(states(sentence, "friOpen") && !states(sentence, "friSetup")) << sentence;
}

TEST(LwrOpen, AcceptsADelayedFirstMeasurement) {
  FakeController krc;
  lwr::LwrOptions options = quick_options();
  options.max_age_s = 1e-6;  // every packet is older than that
  krc.port = options.port;
  const lwr::fri::MsrPacket first =
      krc.next();  // sent again and again, as a controller in virtual time does
  std::atomic<bool> done{false};
  std::thread sender([&] {
    while (!done) {
      krc.send(first);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  });
  EXPECT_EQ(refusal(options), "");
  done = true;
  sender.join();
}

TEST(LwrOpen, ReportsThatOnlyOtherControllersSend) {
  FakeController krc;
  lwr::LwrOptions options = quick_options();
  options.connect_timeout_s = 0.05;
  options.controller = "127.0.0.9";
  krc.port = options.port;
  std::string sentence;
  krc.serve_while([&] { sentence = refusal(options); });
  EXPECT_TRUE(states(sentence, "127.0.0.9") && states(sentence, "'controller'")) << sentence;
}

TEST(LwrOpen, RefusesAnUnsupportedPeriod) {
  FakeController krc;
  lwr::LwrOptions options = quick_options();
  krc.port = options.port;
  krc.msr.interface.msr_period_s = 0.0F;
  std::string sentence;
  krc.serve_while([&] { sentence = refusal(options); });
  EXPECT_TRUE(states(sentence, " 0 s") && states(sentence, "1 to 100 ms")) << sentence;
}

TEST(LwrOpen, RefusesAnArmWithADriveError) {
  FakeController krc;
  lwr::LwrOptions options = quick_options();
  krc.port = options.port;
  krc.msr.robot.error = 0x08;
  std::string sentence;
  krc.serve_while([&] { sentence = refusal(options); });
  EXPECT_TRUE(states(sentence, " A3") && !states(sentence, "A2") && !states(sentence, "A4"))
      << sentence;
}

TEST(LwrOpen, OpensWithDrivesOffAndWaitsForThem) {
  FakeController krc;
  krc.msr.robot.power = 0;
  const auto driver = krc.open();
  EXPECT_EQ(cycle(krc, *driver).written.error(), devices::DeviceError::kRecoverable);
  EXPECT_EQ(driver->session().diagnostic(), lwr::fri::Diagnostic::kDrivesNotOn);
  krc.msr.robot.power = lwr::fri::kAllDrives;
  EXPECT_TRUE(run_to_command(krc, *driver));
}

TEST(LwrOpen, RefusesInvalidOptions) {
  const auto refused = [](auto change, const char* field) {
    lwr::LwrOptions options = quick_options();
    change(options);
    const std::string sentence = refusal(options);
    EXPECT_TRUE(states(sentence, field)) << field << ": " << sentence;
  };
  refused([](lwr::LwrOptions& o) { o.capture_file = "/nowhere/at/all.pcap"; },
          "/nowhere/at/all.pcap");
}

TEST(LwrOpen, ReopensOnTheSamePort) {
  FakeController krc;
  const lwr::LwrOptions options = quick_options();
  for (int n = 0; n < 3; ++n) {
    auto driver = krc.open(options);
    EXPECT_TRUE(run_to_command(krc, *driver)) << n;
    if (n == 1)
      driver.reset();  // without a clean end: the program still runs at the next start
    else
      krc.close(std::move(driver));
  }
}

TEST(LwrOpen, WritesReceivedAndSentPackets) {
  const std::string file = testing::TempDir() + "voxtouch_lwr_capture.pcap";
  FakeController krc;
  lwr::LwrOptions options = quick_options();
  options.capture_file = file;
  options.capture_packets = 100;
  {
    auto driver = krc.open(options);
    for (int n = 0; n < 200; ++n)
      cycle(krc, *driver);
    krc.close(std::move(driver));
  }
  const auto size = std::filesystem::file_size(file);
  EXPECT_GT(size, 24 + 100 * (16 + 28 + 376));
  EXPECT_LT(size, 24 + 100 * (16 + 28 + 916));
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace voxtouch::test
