// A recorder that is told to take part hears a session in real time from its first sample on, and
// one that does not come keeps no node from running.
#include "nodes/runtime/recorder_gate.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <optional>

#include "nodes/bus/reader.hpp"
#include "nodes/coupling/coupling_node.hpp"
#include "nodes/device/device_node.hpp"
#include "nodes/rendering/rendering_node.hpp"
#include "tests/support/stand_in.hpp"
#include "tests/unit/nodes/around_coupling.hpp"
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
      : node(kDomain, "logger", rig),
        reader(node.participant, topic, rig, deep_tap()) {
    node.say(0);
  }
  std::optional<std::uint64_t> first() {
    T sample;
    while (reader.take(sample))
      if (!number)
        number = sample.sequence_number;
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

/// Only a logger that hears it opens a node's gate: without a clock that would do so too.
class RecorderGate : public testing::Test {
 protected:
  RecorderGate() { runtime::RecorderGate::patience_ns = std::numeric_limits<std::int64_t>::max(); }
  ~RecorderGate() override { runtime::RecorderGate::patience_ns = kDefault; }
  const std::int64_t kDefault = runtime::RecorderGate::patience_ns;
};

/// By given times, so that nothing but what is asked opens it.
TEST_F(RecorderGate, OpensWhenALoggerHearsThisWriterAndForNobodyElse) {
  const std::string rig = own_rig("o");
  StandIn node(kDomain, "device", rig);
  runtime::NodeRegistry registry(node.participant, rig);
  bus::Writer<msg::DeviceState> states(node.participant, qos::kDeviceState, rig,
                                       qos::profile(qos::ProfileId::kStream));
  runtime::NodeOptions options;
  EXPECT_TRUE(runtime::RecorderGate(options).open()) << "nobody is to record";
  options.peers = {"logger"};
  runtime::RecorderGate gate(options);
  const auto opens = [&] {
    registry.update();
    gate.look(registry, states, 1'000);
    return gate.open();
  };
  EXPECT_FALSE(opens());
  StandIn reader_of_another(kDomain, "validator", rig), silent_logger(kDomain, "logger", rig);
  bus::Reader<msg::DeviceState> another(reader_of_another.participant, qos::kDeviceState, rig,
                                        deep_tap());
  reader_of_another.say(0), silent_logger.say(0);
  ASSERT_TRUE(wait_until([&] {
    return opens() ||
           (registry.find("logger") && registry.find("validator") && states.matched_count() == 1);
  }));
  EXPECT_FALSE(opens()) << "the one that reads is no logger, and the logger does not read this";
  bus::Reader<msg::DeviceState> its(silent_logger.participant, qos::kDeviceState, rig, deep_tap());
  ASSERT_TRUE(wait_until(opens));
  options.lockstep = true;
  EXPECT_TRUE(runtime::RecorderGate(options).open()) << "in lockstep the links are waited for";
}

TEST_F(RecorderGate, OpensByItselfAfterFiveSecondsWhereNoLoggerComes) {
  runtime::RecorderGate::patience_ns = kDefault;
  constexpr std::int64_t kFirst = -7'000, kPatience = 5'000'000'000;
  const std::string rig = own_rig("i");
  StandIn node(kDomain, "device", rig);
  runtime::NodeRegistry registry(node.participant, rig);
  bus::Writer<msg::DeviceState> states(node.participant, qos::kDeviceState, rig,
                                       qos::profile(qos::ProfileId::kStream));
  runtime::NodeOptions options;
  options.peers = {"logger"};
  runtime::RecorderGate gate(options);
  for (const std::int64_t now_ns : {kFirst, kFirst + kPatience}) {
    gate.look(registry, states, now_ns);
    EXPECT_FALSE(gate.open()) << now_ns;
  }
  gate.look(registry, states, kFirst + kPatience + 1);
  EXPECT_TRUE(gate.open());
}

TEST_F(RecorderGate, RenderingAnswersItsFirstSampleWhenTheLoggerHearsIt) {
  const std::string rig = own_rig("g");
  StandIn device(kDomain, "device", rig);
  runtime::NodeRegistry registry(device.participant, rig);
  bus::Writer<msg::DeviceDescription> descriptions(device.participant, qos::kDeviceDescription, rig,
                                                   qos::profile(qos::ProfileId::kLatched));
  bus::Writer<msg::DeviceState> states(device.participant, qos::kDeviceState, rig,
                                       qos::profile(qos::ProfileId::kStream));
  auto options = node_options<rendering_node::Options>(rig, "plane");
  options.peers = {"logger"};
  NodeThread rendering(
      [&](const std::atomic<bool>& stop) { return rendering_node::run(options, stop); });
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
  for (int n = 0; n < 200; ++n)
    write();
  EXPECT_EQ(figure_of(registry, "rendering", "samples"), 0.0) << "nobody records it yet";
  Recorder<msg::ContactState> recorder(qos::kContactState, rig);
  ASSERT_TRUE(wait_until([&] {
    return write(),
           recorder.first().has_value() && figure_of(registry, "rendering", "samples") > 0.0;
  }));
  EXPECT_EQ(static_cast<double>(*recorder.first()),
            figure_of(registry, "rendering", "first_sample"));
}

TEST_F(RecorderGate, CouplingCommandsForTheFirstTimeWhenTheLoggerHearsIt) {
  const std::string rig = own_rig("k");
  StandIn device(kDomain, "device", rig), rendering(kDomain, "rendering", rig);
  runtime::NodeRegistry registry(device.participant, rig);
  bus::Writer<msg::DeviceDescription> descriptions(device.participant, qos::kDeviceDescription, rig,
                                                   qos::profile(qos::ProfileId::kLatched));
  bus::Writer<msg::ScenePlan> plans(rendering.participant, qos::kScenePlan, rig,
                                    qos::profile(qos::ProfileId::kLatched));
  bus::Writer<msg::ContactState> contacts(rendering.participant, qos::kContactState, rig,
                                          qos::profile(qos::ProfileId::kStream));
  auto options = node_options<coupling_node::Options>(rig);
  options.scene = around_coupling::scene_with("{design: auto}"), options.peers = {"logger"};
  NodeThread coupling(
      [&](const std::atomic<bool>& stop) { return coupling_node::run(options, stop); });
  ASSERT_TRUE(wait_until([&] {
    return contacts.matched_count() == 1 && plans.matched_count() == 1 &&
           descriptions.matched_count() == 1;
  })) << coupling.error();
  descriptions.write(stylus(7));
  plans.write(around_coupling::Around::message_of(30.0, 7, {0.0, 0.0, ""}));
  device.say(7), rendering.say(7);
  msg::ContactState contact{};
  contact.session_id = 7, contact.tool_pose.orientation.w = 1.0;
  const auto write = [&] {
    contacts.write(contact);
    ++contact.sequence_number, contact.sample_time_ns += 1'000'000;
    std::this_thread::sleep_for(milliseconds(1));
  };
  const auto says = [&] {
    registry.update();
    const auto report = registry.find("coupling");
    return report ? report->message : "";
  };
  ASSERT_TRUE(wait_until([&] { return write(), says().contains("logger"); })) << says();
  for (int n = 0; n < 200; ++n)
    write();
  EXPECT_EQ(figure_of(registry, "coupling", "samples"), 0.0) << "nobody records it yet";
  EXPECT_EQ(figure_of(registry, "coupling", runtime::kSessions), 0.0);
  Recorder<msg::ForceCommand> recorder(qos::kForceCommand, rig);
  ASSERT_TRUE(wait_until([&] {
    return write(),
           recorder.first().has_value() && figure_of(registry, "coupling", "samples") > 0.0;
  })) << says();
  EXPECT_EQ(static_cast<double>(*recorder.first()),
            figure_of(registry, "coupling", "first_sample"));
}

TEST_F(RecorderGate, ASimulatedDeviceWritesItsFirstSampleWhenTheLoggerHearsIt) {
  const std::string rig = own_rig("h");
  auto options = node_options<device_node::Options>(rig, "plane");
  options.device = "sim-phantom", options.peers = {"logger"};
  NodeThread device([&](const std::atomic<bool>& stop) { return device_node::run(options, stop); });
  std::this_thread::sleep_for(
      milliseconds(1500));  // it has looked for another device, and would have begun
  Recorder<msg::DeviceState> recorder(qos::kDeviceState, rig);
  ASSERT_TRUE(wait_until([&] { return recorder.first().has_value(); })) << device.error();
  EXPECT_EQ(*recorder.first(), 0U);
}

}  // namespace
}  // namespace voxtouch::test
