#include <gtest/gtest.h>

#include <csignal>

#include <sched.h>

#include <CLI/CLI.hpp>

#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/latency.hpp"
#include "nodes/runtime/options.hpp"
#include "nodes/runtime/participation.hpp"
#include "nodes/runtime/signals.hpp"

namespace voxtouch::runtime {
namespace {

TEST(Deadline, StaysOnTheGridWhenTheLoopIsInTime) {
  const Deadline next = next_deadline(1'000'000, 1'400'000, 1'000'000);
  EXPECT_EQ(next.at_ns, 2'000'000);
  EXPECT_EQ(next.skipped, 0U);
}

TEST(Deadline, SkipsAndCountsWhatALateLoopHasMissed) {
  const Deadline next = next_deadline(1'000'000, 4'500'000, 1'000'000);
  EXPECT_EQ(next.at_ns, 5'000'000);
  EXPECT_EQ(next.skipped, 3U);  // 2, 3 and 4 ms
}

TEST(Deadline, IsNeverInThePast) {
  for (std::int64_t now = 0; now < 20'000; now += 7)
    EXPECT_GE(next_deadline(0, now, 1'000).at_ns, now);
}

TEST(LatencyHistogram, GivesQuantilesAndMaximum) {
  LatencyHistogram h;
  for (int i = 1; i <= 100; ++i)
    h.record(i * 1'000);
  EXPECT_EQ(h.count(), 100U);
  EXPECT_NEAR(h.quantile_us(0.5), 51.0, 1.0);
  EXPECT_NEAR(h.quantile_us(0.99), 100.0, 1.0);
  EXPECT_EQ(h.max_us(), 100.0);
  h.record(10'000'000'000);
  EXPECT_EQ(h.max_us(), 1e7);
}

TEST(LatencyHistogram, IsZeroWithoutSamples) {
  EXPECT_EQ(LatencyHistogram().quantile_us(0.5), 0.0);
}

TEST(Signals, AHangupUnderNohupStopsNothing) {
  std::signal(SIGHUP, SIG_IGN);
  catch_signals();
  std::raise(SIGHUP);
  EXPECT_FALSE(stop_requested().load());
  std::signal(SIGHUP, SIG_DFL);
  catch_signals();
  std::raise(SIGHUP);
  EXPECT_TRUE(stop_requested().exchange(false));
}

TEST(NodeOptions, TakeOnlyCpusThatThereAre) {
  cpu_set_t allowed;
  ASSERT_EQ(sched_getaffinity(0, sizeof allowed, &allowed), 0);
  for (int cpu = 0; cpu < 2000; ++cpu)
    EXPECT_EQ(require_cpu(std::to_string(cpu)).empty(),
              cpu < CPU_SETSIZE && CPU_ISSET(static_cast<unsigned>(cpu), &allowed))
        << cpu;
  for (const char* text : {"", "-1", "99999", "0x1", "1.0", " 0", "nan"}) {
    EXPECT_FALSE(require_cpu(text).empty()) << text;
    EXPECT_NE(require_cpu(text).find("; available "), std::string::npos) << require_cpu(text);
  }
  cpu_set_t one;
  CPU_ZERO(&one);
  const auto first = static_cast<unsigned>(sched_getcpu());
  CPU_SET(first, &one);
  ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
  EXPECT_EQ(require_cpu(std::to_string(first)), "");
  for (unsigned cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (cpu != first) {
      EXPECT_FALSE(require_cpu(std::to_string(cpu)).empty()) << "not in this process's mask";
    }
  sched_setaffinity(0, sizeof allowed, &allowed);
}

TEST(NodeOptions, RefuseAmbiguousArguments) {
  for (const char* text : {"", "-1", "+1", "1.5", "1e3", "0x10", "nan", "18446744073709551616",
                           "99999999999999999999999"}) {
    EXPECT_FALSE(require_whole(text).empty()) << text;
    EXPECT_FALSE(require_count(text).empty()) << text;
  }
  EXPECT_EQ(require_whole("18446744073709551615"), "");
  EXPECT_EQ(require_whole("0"), "");
  EXPECT_EQ(require_count("1"), "");
  EXPECT_FALSE(require_count("0").empty());
  for (const char* name : {"rt/joint_states", "rt/*", "DCPSTopic"})
    EXPECT_EQ(check_topic(name), "") << name;
  for (const std::string& name :
       {std::string(), std::string("a b"), std::string("a\x1b[2J"), std::string(257, 'x')})
    EXPECT_FALSE(check_topic(name).empty()) << name;
  const auto parses = [](const std::string& argument) {
    CLI::App app;
    NodeOptions options;
    add_node_options(app, options, false);
    try {
      app.parse(std::vector<std::string>{argument});
    } catch (const CLI::Error&) {
      return false;
    }
    return true;
  };
  const std::string huge(1 << 20, 'x');
  for (const std::string& name : {std::string("haptic"), std::string(64, 'x')})
    EXPECT_TRUE(parses("--rig=" + name));
  for (const std::string& name :
       {huge, std::string(65, 'x'), std::string("a/b"), std::string("9"), std::string("a\n")})
    EXPECT_FALSE(parses("--rig=" + name)) << name.substr(0, 80);
  for (const char* name : {"lo", "eth0.7", "wlp2s0", "192.168.0.1", "fe80::1%eth0"})
    EXPECT_TRUE(parses(std::string("--interface=") + name)) << name;
  for (const std::string& name :
       {huge, std::string("a b"), std::string("\"/><x"), std::string("a\x1b[2J")})
    EXPECT_FALSE(parses("--interface=" + name)) << name.substr(0, 80);
}

TEST(NodeOptions, RoundTripThroughAChildsArguments) {
  NodeOptions given;
  given.scene = "/dev/null";
  given.rig = "left_hand";
  given.domain = 17;
  given.network_interface = "eth7";
  given.discovery_peers = {"10.0.0.2", "lab-pc"};
  given.security = "/home/me/keys";
  given.ros = bus::RosGraph::kHumble;
  given.seed = 99;
  given.lockstep = true;
  given.peers = {"rendering", "coupling"};
  given.realtime.mode = Realtime::kEnforce;
  given.realtime.cpu = sched_getcpu();
  std::vector<std::string> arguments = to_arguments(given, true);
  std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
  CLI::App app;
  NodeOptions got;
  add_node_options(app, got, true);
  app.parse(arguments);
  EXPECT_EQ(got.scene, given.scene);
  EXPECT_EQ(got.rig, given.rig);
  EXPECT_EQ(got.domain, given.domain);
  EXPECT_EQ(got.network_interface, given.network_interface);
  EXPECT_EQ(got.discovery_peers, given.discovery_peers);
  EXPECT_EQ(got.security, given.security);
  EXPECT_EQ(got.ros, given.ros);
  EXPECT_EQ(got.seed, given.seed);
  EXPECT_EQ(got.lockstep, given.lockstep);
  EXPECT_EQ(got.peers, given.peers);
  EXPECT_EQ(got.realtime.mode, given.realtime.mode);
  EXPECT_EQ(got.realtime.cpu, given.realtime.cpu);
}

TEST(NodeOptions, RefuseARigNameThatRosWouldRefuse) {
  CLI::App app;
  NodeOptions options;
  add_node_options(app, options, false);
  EXPECT_THROW(app.parse("--rig 7th/hand"), CLI::ParseError);
}

TEST(Participation, CountsOnlyTheNodesThatTakePart) {
  NodeOptions options;
  options.peers = {"coupling"};
  EXPECT_EQ(taking_part(options, {"device", "coupling", "logger"}),
            (std::vector<std::string>{"device", "coupling"}));
}

}  // namespace
}  // namespace voxtouch::runtime
