// The ROS form of a node's status is made for whoever reads it, and for nobody else.
#include <gtest/gtest.h>

#include "nodes/runtime/roster.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::test {
namespace {

TEST(Diagnostics, AreMadeWhileSomebodyReadsThemAndAtNoOtherTime) {
  constexpr std::uint32_t kOwnDomain = 57;  // /diagnostics has one name for all rigs: another test might read it
  const bus::Participant node({kOwnDomain, "lo", "device"}), tool({kOwnDomain, "lo", "tool"});
  runtime::StatusWriter status(node, "device", own_rig("d"));
  runtime::NodeReport report;
  report.message = "well", report.values = {{"samples", "3"}};
  for (int i = 0; i < 20; ++i) status.publish(report);
  EXPECT_EQ(status.diagnostics_made(), 0U);

  auto reader = std::make_unique<bus::Reader<msg::diagnostic_msgs_DiagnosticArray>>(
      tool, qos::kDiagnostics, "", qos::profile(qos::kDiagnostics.profile));
  std::string message;
  ASSERT_TRUE(wait_until([&] {
    status.publish(report);
    reader->take_each([&](const auto& array) { message = array.status._buffer[0].message; });
    return !message.empty();
  }));
  EXPECT_EQ(message, "well");

  reader.reset();
  std::uint64_t last = 0;
  ASSERT_TRUE(wait_until([&] {  // his going takes a moment to be known
    last = status.diagnostics_made();
    status.publish(report);
    return status.diagnostics_made() == last;
  }));
  for (int i = 0; i < 20; ++i) status.publish(report);
  EXPECT_EQ(status.diagnostics_made(), last);
}

}  // namespace
}  // namespace voxtouch::test
