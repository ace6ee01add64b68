#include <gtest/gtest.h>

#include "nodes/view/node_table.hpp"

namespace voxtouch::view {
namespace {

constexpr std::int64_t kS = 1'000'000'000;

runtime::NodeReport report(const std::string& node, double samples,
                           runtime::NodeState state = runtime::NodeState::kRunning) {
  runtime::NodeReport r;
  r.node = node, r.state = state;
  r.figures["samples"] = {samples, "samples"};
  return r;
}

TEST(ViewNodeTable, CountsRatesAndOrdersNodesAlongTheLoop) {
  NodeTable table;
  for (int n = 0; n <= 20; ++n)
    for (const char* node : {"coupling", "device"})
      table.update(report(node, 100.0 * n), n * kS / 10);
  const auto rows = table.rows(2 * kS);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].report.node, "device");
  EXPECT_NEAR(rows[0].rate_hz.value(), 1000.0, 1.0);
}

TEST(ViewNodeTable, ShowsNodesThatVanished) {
  NodeTable table;
  table.update(report("device", 0), 0);
  table.update(report("coupling", 0, runtime::NodeState::kStopped), 0);
  table.update(report("rendering", 0), 5 * kS);
  const auto rows = table.rows(5 * kS);
  EXPECT_EQ(rows[0].state, "gone");
  EXPECT_TRUE(rows[0].report.message.contains(" 5 s ")) << rows[0].report.message;
  EXPECT_EQ(rows[1].state, "running");
  EXPECT_EQ(rows[2].state, "stopped");
}

TEST(ViewNodeTable, IsBounded) {
  NodeTable table;
  for (int n = 0; n < 1000; ++n)
    table.update(report("node" + std::to_string(n), 0), 0);
  EXPECT_EQ(table.rows(0).size(), NodeTable::kMaxNodes);
}

}  // namespace
}  // namespace voxtouch::view
