// A recorder that is told to take part hears a session in real time from its first sample on, and one that does not come keeps no node from running.
#include "nodes/runtime/recorder_gate.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "nodes/bus/reader.hpp"
#include "nodes/device/device_node.hpp"
#include "nodes/rendering/rendering_node.hpp"
#include "tests/support/stand_in.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds;

/// A tap that has room for all that a test sends, however long it stands still.
const qos::Profile& deep_tap() {
  static const qos::Profile profile = [] {
    qos::Profile p = qos::profile(qos::ProfileId::kTap);
    p.depth = 20'000;
    return p;
  }();
  return profile;
}

/// Reads a stream as the logger does, as soon as it is there.
template <class T>
struct Recorder {
  Recorder(const qos::Topic& topic, const std::string& rig)
      : node(kDomain, "logger", rig), reader(node.participant, topic, rig, deep_tap()) {
    node.say(0);
  }
  std::optional<std::uint64_t> first() {
    T sample;
    while (reader.take(sample))
      if (!number) number = sample.sequence_number;
    return number;
  }
  StandIn node;
  bus::Reader<T> reader;
  std::optional<std::uint64_t> number;
};

double figure_of(runtime::NodeRegistry& registry, const std::string& node, const char* name) {
  registry.update();
  const auto report = registry.find(node);
  return report ? runtime::value_of(report->figures, name) : 0.0;
}

TEST(RecorderGate, RenderingAnswersItsFirstSampleWhenTheLoggerHearsIt) {
  const std::string rig = own_rig("g");
  StandIn device(kDomain, "device", rig);
  runtime::NodeRegistry registry(device.participant, rig);
  bus::Writer<msg::DeviceDescription> descriptions(device.participant, qos::kDeviceDescription, rig, qos::profile(qos::ProfileId::kLatched));
  bus::Writer<msg::DeviceState> states(device.participant, qos::kDeviceState, rig, qos::profile(qos::ProfileId::kStream));
  auto options = node_options<rendering_node::Options>(rig, "plane");
  options.peers = {"logger"};
  NodeThread rendering([&](const std::atomic<bool>& stop) { return rendering_node::run(options, stop); });
  ASSERT_TRUE(wait_until([&] { return states.matched_count() == 1; })) << rendering.error();
  descriptions.write(stylus(7));
  device.say(7);
  msg::DeviceState state{};
  state.session_id = 7, state.pose.position.z = 0.05, state.pose.orientation.w = 1.0;
  const auto write = [&] {
    states.write(state);
    ++state.sequence_number, state.sample_time_ns += 1'000'000;
    std::this_thread::sleep_for(milliseconds(1));
  };
  for (int n = 0; n < 200; ++n) write();
  EXPECT_EQ(figure_of(registry, "rendering", "samples"), 0.0) << "nobody records it yet";
  Recorder<msg::ContactState> recorder(qos::kContactState, rig);
  ASSERT_TRUE(wait_until([&] { return write(), recorder.first().has_value() && figure_of(registry, "rendering", "samples") > 0.0; }));
  EXPECT_EQ(static_cast<double>(*recorder.first()), figure_of(registry, "rendering", "first_sample"));
}

TEST(RecorderGate, ASimulatedDeviceWritesItsFirstSampleWhenTheLoggerHearsIt) {
  const std::string rig = own_rig("h");
  auto options = node_options<device_node::Options>(rig, "plane");
  options.device = "sim-phantom", options.peers = {"logger"};
  NodeThread device([&](const std::atomic<bool>& stop) { return device_node::run(options, stop); });
  std::this_thread::sleep_for(milliseconds(1500));  // it has looked for another device, and would have begun
  Recorder<msg::DeviceState> recorder(qos::kDeviceState, rig);
  ASSERT_TRUE(wait_until([&] { return recorder.first().has_value(); })) << device.error();
  EXPECT_EQ(*recorder.first(), 0U);
}

/// Takes five seconds, as long as a node waits.
TEST(RecorderGate, OpensByItselfWhereNoLoggerComes) {
  const std::string rig = own_rig("i");
  StandIn node(kDomain, "device", rig);
  runtime::NodeRegistry registry(node.participant, rig);
  bus::Writer<msg::DeviceState> states(node.participant, qos::kDeviceState, rig, qos::profile(qos::ProfileId::kStream));
  runtime::NodeOptions options;
  EXPECT_TRUE(runtime::RecorderGate(options).open()) << "nobody is to record";
  options.peers = {"logger"};
  runtime::RecorderGate gate(options);
  const std::int64_t begin_ns = runtime::monotonic_ns();
  EXPECT_TRUE(wait_until([&] { return gate.look(registry, states), gate.open(); }));
  EXPECT_GE(runtime::monotonic_ns() - begin_ns, runtime::RecorderGate::kPatienceNs);
  options.lockstep = true;
  EXPECT_TRUE(runtime::RecorderGate(options).open()) << "in lockstep the links are waited for";
}

}  // namespace
}  // namespace voxtouch::test
