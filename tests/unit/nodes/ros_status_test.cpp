// A node's sentences for ROS tools: lines of /rosout with a limited rate.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "nodes/bus/reader.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/ros_log.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::test {
namespace {

using runtime::NodeState;

struct Line {
  int level;
  std::string name, text;
};

class RosLines : public testing::Test {
 protected:
  void listen() {
    reader = std::make_unique<bus::Reader<msg::rcl_interfaces_Log>>(
        listener, qos::kRosout, rig, qos::profile(qos::kRosout.profile));
    ASSERT_TRUE(wait_until([&] { return log.reader_came(); }));
  }
  void take() {
    reader->take_each([&](const msg::rcl_interfaces_Log& line) {
      lines.push_back({line.level, line.name, line.msg});
    });
  }
  bool has(std::size_t count) {
    return wait_until([&] { return take(), lines.size() >= count; });
  }
  const std::string rig = own_rig("l");
  bus::Participant node{{kDomain, "lo", "node"}}, listener{{kDomain, "lo", "listener"}};
  runtime::RosLog log{node, "coupling", rig};
  std::unique_ptr<bus::Reader<msg::rcl_interfaces_Log>> reader;
  std::vector<Line> lines;
};

TEST_F(RosLines, AreLimitedToTenASecondAndCountTheRest) {
  log.write(NodeState::kRunning, "none reads this");
  EXPECT_EQ(log.written(), 0U);
  listen();
  constexpr int kSaid = 5000;
  const std::int64_t begin_ns = runtime::monotonic_ns();
  for (int n = 0; n < kSaid; ++n)
    log.write(NodeState::kRunning, "sentence " + std::to_string(n));
  const std::uint64_t of_the_flood = log.written();
  // A stalled machine makes it longer, and then more lines fit.
  const auto seconds =
      static_cast<std::uint64_t>((runtime::monotonic_ns() - begin_ns) / 1'000'000'000);
  EXPECT_GE(of_the_flood, 10U);
  EXPECT_LE(of_the_flood, 10U * (seconds + 2));
  ASSERT_TRUE(wait_until(
      [&] { return log.write(NodeState::kRunning, "at last"), log.written() > of_the_flood; }));
  ASSERT_TRUE(has(of_the_flood + 1));
  EXPECT_EQ(lines.front().text, "sentence 0");
  EXPECT_EQ(lines.front().name, rig + ".coupling");
  EXPECT_NE(lines.back().text.find(" lines skipped"), std::string::npos) << lines.back().text;
}

TEST_F(RosLines, CarryTheirSeverity) {
  listen();
  log.write(NodeState::kRunning, "all runs"),
      log.write(NodeState::kRunning, "warning: the scenes differ"),
      log.write(NodeState::kFailed, "No force is commanded.");
  ASSERT_TRUE(has(3));
  EXPECT_EQ((std::vector{lines[0].level, lines[1].level, lines[2].level}),
            (std::vector{20, 30, 40}));
}

}  // namespace
}  // namespace voxtouch::test
