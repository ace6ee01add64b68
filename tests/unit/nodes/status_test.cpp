// A node's status arrives as it was set: words as words, numbers as numbers. The ROS form of a
// status is made only if it has a reader.
#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <thread>

#include "nodes/runtime/node_monitor.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::test {
namespace {

TEST(Diagnostics, AreMadeOnlyWhileRead) {
  constexpr std::uint32_t kOwnDomain =
      57;  // /diagnostics has one name for all rigs: another test might read it
  const bus::Participant node({kOwnDomain, "lo", "device"}), tool({kOwnDomain, "lo", "tool"});
  runtime::StatusWriter status(node, "device", own_rig("d"));
  runtime::NodeReport report;
  report.message = "well", report.values = {{"scene", "cup"}};
  report.figures = {{"samples", {12'345'678, "samples"}}, {"rate_hz", {999.75, "Hz"}}};
  for (int i = 0; i < 20; ++i)
    status.publish(report);
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
  EXPECT_EQ(said,
            (std::map<std::string, std::string>{
                {"scene", "cup"}, {"samples", "12345678 samples"}, {"rate_hz", "999.75 Hz"}}));

  reader.reset();
  std::uint64_t last = 0;
  ASSERT_TRUE(wait_until([&] {  // his going takes a moment to be known
    last = status.diagnostics_made();
    status.publish(report);
    return status.diagnostics_made() == last;
  }));
  for (int i = 0; i < 20; ++i)
    status.publish(report);
  EXPECT_EQ(status.diagnostics_made(), last);
}

TEST(Status, CarriesFiguresExactly) {
  const bus::Participant node({kDomain, "lo", "device"}), other({kDomain, "lo", "other"});
  runtime::StatusWriter status(node, "device", own_rig());
  runtime::NodeRegistry registry(other, own_rig());
  runtime::NodeReport report;
  report.values = {{"scene", "cup"}};
  report.figures = {{"third", {1.0 / 3.0, "N"}},
                    {"samples", {9'007'199'254'740'992ULL, "samples"}}};
  std::optional<runtime::NodeReport> seen;
  ASSERT_TRUE(wait_until([&] {
    status.publish(report);
    registry.update();
    return (seen = registry.find("device")).has_value();
  }));
  EXPECT_EQ(seen->values, report.values);
  ASSERT_EQ(seen->figures.size(), 2U);
  EXPECT_EQ(seen->figures.at("third").value, 1.0 / 3.0);
  EXPECT_EQ(seen->figures.at("third").unit, "N");
  EXPECT_EQ(runtime::as_count(seen->figures.at("samples").value), 9'007'199'254'740'992ULL);
  EXPECT_EQ(runtime::value_of(seen->figures, "nothing"), 0.0);
}

TEST(Status, ConvertsInvalidCountsToAValidCount) {
  EXPECT_EQ(runtime::as_count(std::numeric_limits<double>::quiet_NaN()), 0U);
  EXPECT_EQ(runtime::as_count(-3.0), 0U);
  EXPECT_EQ(runtime::as_count(std::numeric_limits<double>::infinity()), 9'007'199'254'740'992ULL);
  EXPECT_EQ(runtime::as_count(7.0), 7U);
}

/// Two nodes of a rig, one with a loop that the test blocks, and a reader of their statuses.
class TwoNodes : public testing::Test {
 protected:
  TwoNodes() {
    options.rig = own_rig();
    const auto well = [](runtime::NodeRegistry&, runtime::NodeReport& report) {
      report.message = "well", report.state = runtime::NodeState::kRunning;
    };
    rendering.emplace(
        first, "rendering", options, well,
        std::vector<runtime::Watched>{{"its loop", [this] { return stuck ? 1U : ++beats; }}});
    device.emplace(second, "device", options, well);
    registry.emplace(third, options.rig);
  }
  /// Whether the last status of `node` eventually satisfies this.
  bool comes_to(const char* node, const std::function<bool(const runtime::NodeReport&)>& holds) {
    return wait_until([&] {
      registry->update();
      const auto report = registry->find(node);
      return report && holds(*report);
    });
  }
  std::atomic<bool> stuck{false};
  std::atomic<std::uint64_t> beats{10};
  runtime::NodeOptions options;
  bus::Participant first{{kDomain, "lo", "first"}}, second{{kDomain, "lo", "second"}},
      third{{kDomain, "lo", "third"}};
  std::optional<runtime::NodeMonitor> rendering, device;
  std::optional<runtime::NodeRegistry> registry;
};

TEST_F(TwoNodes, BothReportAStalledLoop) {
  const auto is_well = [](const runtime::NodeReport& report) { return report.message == "well"; };
  ASSERT_TRUE(comes_to("rendering", is_well) && comes_to("device", is_well));
  stuck = true;
  EXPECT_TRUE(comes_to("rendering", [](const auto& r) {
    return r.message.contains("its loop") && r.message.contains(" 0.4 s");
  }));
  EXPECT_TRUE(comes_to("device", [](const auto& r) {
    return r.message.contains("rendering hangs") && r.message.contains(" 0.4 s");
  }));
  ASSERT_EQ(registry->hung().size(), 1U);
  EXPECT_EQ(registry->hung()[0].node, "rendering");
  stuck = false;
  EXPECT_TRUE(comes_to("rendering", is_well));
  EXPECT_TRUE(comes_to("device", is_well));
  EXPECT_TRUE(registry->hung().empty());
  EXPECT_TRUE(comes_to(
      "rendering", [](const auto& r) { return r.figures.at(runtime::kLongestStall).value > 0.4; }));
}

TEST_F(TwoNodes, ReportTenTimesASecondAndAreNotHung) {
  ASSERT_TRUE(comes_to("device", [](const auto&) { return true; }));
  int received = 0;
  std::int64_t last = 0;
  for (int n = 0; n < 100; ++n) {
    ASSERT_TRUE(comes_to("device", [](const auto&) { return true; }));
    if (const std::int64_t at = registry->find("device")->received_ns; at != last)
      last = at, ++received;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_GE(received, 10) << "in two seconds, on a busy machine";
  EXPECT_TRUE(registry->hung().empty());
}

TEST_F(TwoNodes, VanishedWithoutAFinalReportCountAsHung) {
  ASSERT_TRUE(comes_to("rendering", [](const auto&) { return true; }));
  rendering.reset();  // its last word was that it runs
  EXPECT_TRUE(comes_to("device", [](const auto& r) {
    return r.message.contains("rendering hangs: ") && r.message.contains(" 0.4 s");
  }));
  EXPECT_FALSE(registry->find("rendering"));
  runtime::StatusWriter again(first, "rendering", options.rig);
  EXPECT_TRUE(wait_until([&] {
    again.publish({});
    registry->update();
    return registry->find("device")->message == "well";
  }));
}

TEST_F(TwoNodes, DoNotHangAfterReportingTheirEnd) {
  runtime::NodeReport last;
  last.state = runtime::NodeState::kStopped;
  {
    runtime::StatusWriter coupling(first, "coupling", options.rig);
    ASSERT_TRUE(wait_until([&] {
      coupling.publish(last);
      registry->update();
      return registry->find("coupling").has_value();
    }));
    for (int n = 0; n < 30; ++n) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      registry->update();
    }
    EXPECT_TRUE(registry->hung().empty());
  }
  ASSERT_TRUE(wait_until([&] {
    registry->update();
    return !registry->find("coupling");
  }));
  EXPECT_TRUE(registry->hung().empty());
}

}  // namespace
}  // namespace voxtouch::test
