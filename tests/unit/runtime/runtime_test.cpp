#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/latency.hpp"
#include "nodes/runtime/options.hpp"
#include "nodes/runtime/participation.hpp"

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
  for (int i = 1; i <= 100; ++i) h.record(i * 1'000);
  EXPECT_EQ(h.count(), 100U);
  EXPECT_NEAR(h.quantile_us(0.5), 51.0, 1.0);
  EXPECT_NEAR(h.quantile_us(0.99), 100.0, 1.0);
  EXPECT_EQ(h.max_us(), 100.0);
  h.record(10'000'000'000);
  EXPECT_EQ(h.max_us(), 1e7);
}

TEST(LatencyHistogram, SaysZeroWithoutSamples) { EXPECT_EQ(LatencyHistogram().quantile_us(0.5), 0.0); }

TEST(NodeOptions, ComeBackFromTheArgumentsThatAChildGets) {
  NodeOptions given;
  given.scene = "/dev/null";
  given.rig = "left_hand";
  given.domain = 17;
  given.network_interface = "eth7";
  given.seed = 99;
  given.lockstep = true;
  given.peers = {"rendering", "coupling"};
  given.realtime.mode = Realtime::kEnforce;
  given.realtime.cpu = 1;
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
  EXPECT_EQ(taking_part(options, {"device", "coupling", "logger"}), (std::vector<std::string>{"device", "coupling"}));
}

}  // namespace
}  // namespace voxtouch::runtime
