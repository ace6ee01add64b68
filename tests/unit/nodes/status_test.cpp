// What a node tells of itself arrives as it was told: words as words, numbers as numbers. The ROS form of a node's status is made for whoever reads it, and for nobody else.
#include <gtest/gtest.h>

#include <limits>

#include "nodes/runtime/roster.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::test {
namespace {

TEST(Diagnostics, AreMadeWhileSomebodyReadsThemAndAtNoOtherTime) {
  constexpr std::uint32_t kOwnDomain = 57;  // /diagnostics has one name for all rigs: another test might read it
  const bus::Participant node({kOwnDomain, "lo", "device"}), tool({kOwnDomain, "lo", "tool"});
  runtime::StatusWriter status(node, "device", own_rig("d"));
  runtime::NodeReport report;
  report.message = "well", report.values = {{"scene", "cup"}};
  report.figures = {{"samples", {12'345'678, "samples"}}, {"rate_hz", {999.75, "Hz"}}};
  for (int i = 0; i < 20; ++i) status.publish(report);
  EXPECT_EQ(status.diagnostics_made(), 0U);

  auto reader = std::make_unique<bus::Reader<msg::diagnostic_msgs_DiagnosticArray>>(
      tool, qos::kDiagnostics, "", qos::profile(qos::kDiagnostics.profile));
  std::string message;
  std::map<std::string, std::string> said;
  ASSERT_TRUE(wait_until([&] {
    status.publish(report);
    reader->take_each([&](const auto& array) {
      const auto& made = array.status._buffer[0];
      message = made.message;
      for (std::uint32_t i = 0; i < made.values._length; ++i)
        said[made.values._buffer[i].key] = made.values._buffer[i].value;
    });
    return !message.empty();
  }));
  EXPECT_EQ(message, "well");
  EXPECT_EQ(said, (std::map<std::string, std::string>{
                      {"scene", "cup"}, {"samples", "12345678 samples"}, {"rate_hz", "999.75 Hz"}}));

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

TEST(Status, CarriesFiguresAsNumbersToTheLastBit) {
  const bus::Participant node({kDomain, "lo", "device"}), other({kDomain, "lo", "other"});
  runtime::StatusWriter status(node, "device", own_rig());
  runtime::Roster roster(other, own_rig());
  runtime::NodeReport report;
  report.values = {{"scene", "cup"}};
  report.figures = {{"third", {1.0 / 3.0, "N"}}, {"samples", {9'007'199'254'740'992ULL, "samples"}}};
  std::optional<runtime::NodeReport> seen;
  ASSERT_TRUE(wait_until([&] {
    status.publish(report);
    roster.update();
    return (seen = roster.find("device")).has_value();
  }));
  EXPECT_EQ(seen->values, report.values);
  ASSERT_EQ(seen->figures.size(), 2U);
  EXPECT_EQ(seen->figures.at("third").value, 1.0 / 3.0);
  EXPECT_EQ(seen->figures.at("third").unit, "N");
  EXPECT_EQ(runtime::as_count(seen->figures.at("samples").value), 9'007'199'254'740'992ULL);
  EXPECT_EQ(runtime::value_of(seen->figures, "nothing of that name"), 0.0);
}

TEST(Status, TakesNoFigureForACountThatIsNone) {
  EXPECT_EQ(runtime::as_count(std::numeric_limits<double>::quiet_NaN()), 0U);
  EXPECT_EQ(runtime::as_count(-3.0), 0U);
  EXPECT_EQ(runtime::as_count(std::numeric_limits<double>::infinity()), 9'007'199'254'740'992ULL);
  EXPECT_EQ(runtime::as_count(7.0), 7U);
}

}  // namespace
}  // namespace voxtouch::test
