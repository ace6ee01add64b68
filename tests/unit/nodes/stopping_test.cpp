// A node or `up` that is stopped in any way, and however early, ends by itself and reports the
// result.
#include <gtest/gtest.h>

#include <signal.h>

#include <fstream>
#include <thread>

#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

std::vector<std::string> node(const std::string& name, const std::vector<std::string>& more = {}) {
  std::vector<std::string> a = {VOXTOUCH_BIN "/voxtouch_" + name, "--scene", shipped_scene("plane"),
                                "--domain", fresh_domain()};
  a.insert(a.end(), more.begin(), more.end());
  return a;
}

class EverySignal : public testing::TestWithParam<int> {};

TEST_P(EverySignal, StopsTheDeviceInOrder) {
  Process device(node("device", {"--motion", "free"}));
  std::this_thread::sleep_for(milliseconds(1500));
  device.signal(GetParam());
  EXPECT_EQ(device.wait(seconds(10)).status, 0)
      << "it died instead of bringing the device to zero force";
}

INSTANTIATE_TEST_SUITE_P(Signals, EverySignal, testing::Values(SIGINT, SIGTERM, SIGHUP, SIGQUIT),
                         [](const auto& number) {
                           return "Signal" + std::to_string(number.param);
                         });

TEST(Node, DoesNotOutliveAParentThatDiedEarly) {
  Process device(node("device", {"--with-parent", "1999999999"}));
  EXPECT_NE(device.wait(seconds(10)).status, 128 + SIGKILL)
      << "it went on without any participant to stop it";
}

TEST(Node, RefusesATooLongDuration) {
  for (const char* duration : {"inf", "nan", "1e300", "-1"})
    EXPECT_NE(
        Process(node("device", {"--duration", duration})).wait(seconds(10)).err.find("--duration"),
        std::string::npos)
        << duration;
}

TEST(Node, EndsAfterADurationShorterThanASample) {
  EXPECT_EQ(Process(node("device", {"--duration", "0.0001"})).wait(seconds(10)).status, 0);
}

class StoppedAfter : public testing::TestWithParam<int> {};

TEST_P(StoppedAfter, UpLeavesNothingBehindAndNamesNoNode) {
  Process up(up_arguments(shipped_scene("plane"), {"--motion", "free", "--no-record"}));
  std::this_thread::sleep_for(milliseconds(GetParam()));
  const auto nodes = children_of(up.pid());
  up.signal(SIGINT);
  up.signal(SIGINT);  // and once more, impatiently
  const Finished end = up.wait(seconds(20));
  const bool had_not_begun =
      nodes.empty() &&
      end.status == 128 + SIGINT;  // ended like any program that has nothing to bring home
  EXPECT_TRUE(end.status < 2 || had_not_begun) << "status " << end.status << ": " << end.err;
  EXPECT_EQ(end.out.find("signal"), std::string::npos) << end.out;
  EXPECT_EQ(end.out.find("with status"), std::string::npos) << end.out;
  for (const pid_t pid : nodes)
    EXPECT_NE(::kill(pid, 0), 0) << "node " << pid << " is still there";
}

INSTANTIATE_TEST_SUITE_P(Milliseconds, StoppedAfter,
                         testing::Values(100, 400, 515, 520, 525, 530, 540, 560, 600, 800, 1200,
                                         2500));

pid_t child_called(const Process& up, const std::string& program) {
  for (const pid_t child : children_of(up.pid())) {
    std::ifstream command("/proc/" + std::to_string(child) + "/cmdline");
    std::string path;
    std::getline(command, path, '\0');
    if (path.ends_with(program))
      return child;
  }
  return 0;
}

TEST(Up, DoesNotReportZeroForceOfAKilledDevice) {
  Process up(up_arguments(shipped_scene("plane"),
                          {"--motion", "free", "--no-record", "--duration", "30"}));
  for (int i = 0; i < 500 && !runs(up); ++i)
    std::this_thread::sleep_for(milliseconds(20));
  const pid_t device = child_called(up, "voxtouch_device");
  ASSERT_NE(device, 0);
  ::kill(device, SIGKILL);
  const Finished end = up.wait(seconds(30));
  EXPECT_EQ(end.status, 1);
  const auto summary = parse_summary(end.out);
  ASSERT_EQ(summary["problems"].size(), 1U) << end.out;
  EXPECT_NE(summary["problems"][0].get<std::string>().find("zero force"), std::string::npos)
      << end.out;
}

TEST(Up, NamesOnlyTheNodeThatDied) {
  Process up(up_arguments(shipped_scene("plane"),
                          {"--motion", "free", "--no-record", "--duration", "30"}));
  for (int i = 0; i < 500 && !runs(up); ++i)
    std::this_thread::sleep_for(milliseconds(20));
  const pid_t coupling = child_called(up, "voxtouch_coupling");
  ASSERT_NE(coupling, 0);
  ::kill(coupling, SIGKILL);
  const Finished end = up.wait(seconds(30));
  EXPECT_EQ(end.status, 1);
  const auto summary = parse_summary(end.out);
  ASSERT_EQ(summary["problems"].size(), 1U) << end.out;
  EXPECT_NE(summary["problems"][0].get<std::string>().find("signal 9"), std::string::npos)
      << end.out;
}

}  // namespace
}  // namespace voxtouch::test
