// A hanging node is named, by `up` and by the other nodes, and the run fails; in lockstep no node
// waits for it for ever.
#include <gtest/gtest.h>

#include <signal.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <regex>
#include <thread>

#include "nodes/runtime/node_registry.hpp"
#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

bool wait_until(const std::function<bool()>& holds, milliseconds patience) {
  for (const auto until = Clock::now() + patience; !holds();
       std::this_thread::sleep_for(milliseconds(2)))
    if (Clock::now() > until)
      return false;
  return true;
}

double ms_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

/// Finds the hanging node from the others' statuses.
class Onlooker {
 public:
  Onlooker()
      : participant_({static_cast<std::uint32_t>(std::stoi(fresh_domain())), "lo", "onlooker"}),
        registry_(participant_, "haptic") {}
  bool sees_it_said(const std::string& sentence, const std::string& not_by) {
    registry_.update();
    for (const runtime::NodeReport& report : registry_.reports())
      if (report.node != not_by && report.message.find(sentence) != std::string::npos)
        return true;
    return false;
  }

 private:
  bus::Participant participant_;
  runtime::NodeRegistry registry_;
};

class StoppedNode : public testing::TestWithParam<const char*> {};

std::string only_name(const testing::TestParamInfo<const char*>& info) { return info.param; }
const auto kNodes = testing::Values("device", "rendering", "coupling", "validator", "logger");

TEST_P(StoppedNode, IsNamedByAllAndFailsTheRun) {
  const std::string node = GetParam();
  const TemporaryFolder folder;
  Process up(
      up_arguments(shipped_scene("cup"), {"--motion", "slide", "--duration", "4.5", "--record",
                                          (folder / "bag").string(), "--limit", "silence_s=0.4"}));
  Onlooker onlooker;
  ASSERT_TRUE(wait_until([&] { return runs(up); }, seconds(30))) << up.err();
  std::this_thread::sleep_for(milliseconds(500));
  const pid_t pid = child_called(up.pid(), "voxtouch_" + node);
  ASSERT_NE(pid, 0);
  ASSERT_EQ(::kill(pid, SIGSTOP), 0);
  const auto stopped = Clock::now();
  double up_ms = 0.0, others_ms = 0.0;
  const std::string sentence = node + " hangs";
  EXPECT_TRUE(wait_until(
      [&] {
        if (up_ms == 0.0 && up.err().find(sentence) != std::string::npos)
          up_ms = ms_since(stopped);
        if (others_ms == 0.0 && onlooker.sees_it_said(sentence, node))
          others_ms = ms_since(stopped);
        return up_ms > 0.0 && others_ms > 0.0;
      },
      seconds(4)))
      << up.err();
  ::kill(pid, SIGCONT);
  RecordProperty("named_by_up_ms", std::to_string(up_ms)),
      RecordProperty("named_by_others_ms", std::to_string(others_ms));
  std::printf("%s: named by up after %.0f ms, by another node after %.0f ms\n", node.c_str(), up_ms,
              others_ms);
  const Finished end = up.wait();
  EXPECT_EQ(end.status, 1) << end.err;
  EXPECT_NE(end.err.find(node + " is alive again"), std::string::npos) << end.err;
  const auto summary = parse_summary(end.out);
  ASSERT_TRUE(summary.is_object()) << end.out << end.err;
  EXPECT_EQ(summary["ok"], false);
  EXPECT_EQ(summary["limits"]["silence_s"]["met"], false) << end.out;
  EXPECT_GT(summary["limits"]["silence_s"]["value"], 0.4);
  EXPECT_NE(summary["problems"].dump().find(node), std::string::npos) << end.out;
  if (node == "device") {
    EXPECT_GE(summary["interruptions"], 1) << "it went on with the force that it held";
  }
}

INSTANTIATE_TEST_SUITE_P(RealTime, StoppedNode, kNodes, only_name);

/// A node, and the limit that its suspension of a second and a half breaks. The socket buffers of
/// validator and logger hold all samples of that time.
struct Broken {
  const char *node, *limit;
};

class StoppedForAWhile : public testing::TestWithParam<Broken> {};

TEST_P(StoppedForAWhile, BreaksItsOwnLimit) {
  const auto [node, limit] = GetParam();
  const TemporaryFolder folder;
  std::vector<std::string> more = {"--motion", "slide",        "--duration",
                                   "4",        "--record",     (folder / "bag").string(),
                                   "--limit",  "silence_s=inf"};
  const std::map<std::string, std::string> values = {{"rate_ratio", "0.95"},
                                                     {"overrun_ratio", "0.05"},
                                                     {"answered_ratio", "0.95"},
                                                     {"deadline_miss_ratio", "0.0001"}};
  more.insert(more.end(), {"--limit", std::string(limit) + "=" + values.at(limit)});
  Process up(up_arguments(shipped_scene("cup"), more));
  ASSERT_TRUE(wait_until([&] { return runs(up); }, seconds(30))) << up.err();
  std::this_thread::sleep_for(milliseconds(500));
  const pid_t pid = child_called(up.pid(), std::string("voxtouch_") + node);
  ASSERT_NE(pid, 0);
  ASSERT_EQ(::kill(pid, SIGSTOP), 0);
  std::this_thread::sleep_for(milliseconds(1500));
  ::kill(pid, SIGCONT);
  const Finished end = up.wait();
  EXPECT_EQ(end.status, 1) << end.err;
  const auto summary = parse_summary(end.out);
  ASSERT_TRUE(summary.is_object()) << end.out << end.err;
  EXPECT_EQ(summary["ok"], false);
  EXPECT_EQ(summary["limits"][limit]["met"], false) << summary["limits"].dump();
  EXPECT_EQ(summary["guard"]["refused"], summary["guard"]["refused_late"])
      << "none else sent a command";
}

INSTANTIATE_TEST_SUITE_P(RealTime, StoppedForAWhile,
                         testing::Values(Broken{"device", "rate_ratio"},
                                         Broken{"device", "overrun_ratio"},
                                         Broken{"rendering", "answered_ratio"},
                                         Broken{"coupling", "deadline_miss_ratio"}),
                         [](const auto& one) {
                           return std::string(one.param.node) + "_" + one.param.limit;
                         });

TEST(HungDisk, IsNamedAndFailsTheRun) {
  const TemporaryFolder folder;
  const std::string flag = (folder / "hangs").string();
  Process up(
      up_arguments(shipped_scene("cup"), {"--motion", "slide", "--duration", "5", "--record",
                                          (folder / "bag").string(), "--limit", "silence_s=0.4"}),
      {{"LD_PRELOAD", VOXTOUCH_HUNG_DISK}, {"VOXTOUCH_TEST_DISK_HANGS", flag}});
  Onlooker onlooker;
  ASSERT_TRUE(wait_until([&] { return runs(up); }, seconds(30))) << up.err();
  std::this_thread::sleep_for(milliseconds(1000));
  std::ofstream(flag) << "now";
  const auto stopped = Clock::now();
  EXPECT_TRUE(
      wait_until([&] { return up.err().find("logger hangs") != std::string::npos; }, seconds(4)))
      << up.err();
  std::printf("disk: named by up after %.0f ms\n", ms_since(stopped));
  EXPECT_TRUE(
      wait_until([&] { return onlooker.sees_it_said("logger hangs", "logger"); }, seconds(2)));
  std::filesystem::remove(flag);
  const Finished end = up.wait();
  EXPECT_EQ(end.status, 1) << end.err;
  const auto summary = parse_summary(end.out);
  ASSERT_TRUE(summary.is_object()) << end.out << end.err;
  EXPECT_EQ(summary["limits"]["silence_s"]["met"], false) << end.out;
  EXPECT_NE(summary["problems"].dump().find("(logger"), std::string::npos) << end.out;
  EXPECT_EQ(summary["recording"]["dropped"], 0) << "the queue holds more than a second";
}

TEST(HungDisk, RingStoppedMeanwhileLosesNothing) {
  const TemporaryFolder folder;
  const std::string flag = (folder / "hangs").string();
  Process up(up_arguments(shipped_scene("cup"), {"--motion", "slide", "--duration", "0", "--record",
                                                 (folder / "bag").string()}),
             {{"LD_PRELOAD", VOXTOUCH_HUNG_DISK}, {"VOXTOUCH_TEST_DISK_HANGS", flag}});
  ASSERT_TRUE(wait_until([&] { return runs(up); }, seconds(30))) << up.err();
  std::this_thread::sleep_for(milliseconds(1000));
  std::ofstream(flag) << "now";
  EXPECT_TRUE(
      wait_until([&] { return up.err().find("logger hangs") != std::string::npos; }, seconds(4)));
  up.signal(SIGINT);
  std::this_thread::sleep_for(milliseconds(2500));
  std::filesystem::remove(flag);
  const Finished end = up.wait();
  const auto summary = parse_summary(end.out);
  ASSERT_TRUE(summary.is_object()) << end.out << end.err;
  const auto states = read_ring_topic<msg::DeviceState>(folder / "bag", "/haptic/device/state");
  ASSERT_FALSE(states.empty());
  EXPECT_EQ(states.back().sequence_number + 1, summary["samples"]) << end.out << end.err;
}

class StoppedInLockstep : public testing::TestWithParam<const char*> {};

/// `up` has reported of samples: before the first of them all nodes are there, but the ring has not
/// begun.
bool has_samples(const Process& up) {
  return std::regex_search(up.err(), std::regex(" [1-9][0-9]* samples  force"));
}

TEST_P(StoppedInLockstep, EndsTheRunWithAMessage) {
  const std::string node = GetParam();
  const TemporaryFolder folder;
  Process up(
      up_arguments(shipped_scene("cup"), {"--motion", "slide", "--duration", "3000", "--lockstep",
                                          "--record", (folder / "bag").string()}));
  ASSERT_TRUE(wait_until([&] { return has_samples(up); }, seconds(30))) << up.err();
  const pid_t pid = child_called(up.pid(), "voxtouch_" + node);
  ASSERT_NE(pid, 0);
  ASSERT_EQ(::kill(pid, SIGSTOP), 0);
  const auto stopped = Clock::now();
  const Finished end = up.wait(seconds(50));
  std::printf("%s: the run ended after %.1f s\n", node.c_str(), 1e-3 * ms_since(stopped));
  EXPECT_EQ(end.status, 1) << "128 + 9: it waited for ever\n" << end.err;
  const auto summary = parse_summary(end.out);
  ASSERT_TRUE(summary.is_object()) << end.out << end.err;
  EXPECT_NE(summary["problems"].dump().find(node), std::string::npos) << end.out;
}

INSTANTIATE_TEST_SUITE_P(Lockstep, StoppedInLockstep, kNodes, only_name);

/// It has no status yet, so only a waiting node can report it.
TEST(StoppedInLockstep, IsNamedWhileOthersAwaitItsStart) {
  Process up(up_arguments(shipped_scene("cup"),
                          {"--motion", "slide", "--duration", "1", "--lockstep", "--no-record"}));
  pid_t validator = 0;
  ASSERT_TRUE(wait_until(
      [&] { return (validator = child_called(up.pid(), "voxtouch_validator")) != 0; }, seconds(30)))
      << up.err();
  ASSERT_EQ(::kill(validator, SIGSTOP), 0);
  EXPECT_TRUE(
      wait_until([&] { return std::regex_search(up.err(), std::regex("waiting.* validator\n")); },
                 seconds(20)))
      << up.err();
  EXPECT_EQ(up.err().find(" samples  force"), std::string::npos) << up.err();
  ::kill(validator, SIGCONT);
  EXPECT_EQ(up.wait(seconds(50)).status, 0) << up.err();
}

TEST(StoppedInLockstep, EndsManuallyStartedNodesToo) {
  const std::string scene = shipped_scene("plane");
  const auto start = [&](const std::string& node, std::vector<std::string> more) {
    std::vector<std::string> a = {VOXTOUCH_BIN "/voxtouch_" + node,
                                  "--scene",
                                  scene,
                                  "--domain",
                                  fresh_domain(),
                                  "--lockstep",
                                  "--peers",
                                  "rendering,coupling"};
    a.insert(a.end(), more.begin(), more.end());
    return std::make_unique<Process>(a);
  };
  const auto rendering = start("rendering", {}), coupling = start("coupling", {});
  const auto device = start("device", {"--motion", "slide", "--duration", "3000"});
  ASSERT_TRUE(
      wait_until([&] { return device->err().find("running") != std::string::npos; }, seconds(30)))
      << device->err();
  std::this_thread::sleep_for(milliseconds(500));
  device->signal(SIGSTOP);
  for (Process* node : {rendering.get(), coupling.get()}) {
    const Finished end = node->wait(seconds(30));
    EXPECT_EQ(end.status, 1) << end.err;
    EXPECT_TRUE(std::regex_search(end.err, std::regex("device.* 5 s"))) << end.err;
  }
  device->signal(SIGCONT);
  EXPECT_EQ(device->wait(seconds(30)).status, 1);
}

}  // namespace
}  // namespace voxtouch::test
