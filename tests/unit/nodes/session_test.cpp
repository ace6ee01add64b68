// Sessions: effects of a restarted device, a second rig or a second device on running nodes.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/coupling/coupling_node.hpp"
#include "nodes/device/device_node.hpp"
#include "nodes/rendering/rendering_node.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/participation.hpp"
#include "tests/support/stand_in.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds;

template <class T>
double force(const T& m) {
  return std::hypot(m.wrench.force.x, m.wrench.force.y, m.wrench.force.z);
}

/// Everything that a bystander sees of one rig.
class Bystander {
 public:
  explicit Bystander(const std::string& rig)
      : participant({kDomain, "lo", "bystander"}),
        registry(participant, rig),
        descriptions(participant, qos::kDeviceDescription, rig, latched()),
        plans(participant, qos::kScenePlan, rig, latched()),
        designs(participant, qos::kCouplingDesign, rig, latched()),
        states(participant, qos::kDeviceState, rig, tap()),
        contacts(participant, qos::kContactState, rig, tap()),
        commands(participant, qos::kForceCommand, rig, tap()) {}
  void poll() {
    registry.update();
    descriptions.take_each([this](const auto& m) { note(described, m.session_id); });
    plans.take_each([this](const auto& m) { note(planned, m.session_id); });
    designs.take_each([this](const auto& m) { note(designed, m.session_id); });
    msg::DeviceState state;
    while (states.take(state))
      newest = state;
    msg::ContactState contact;
    while (contacts.take(contact))
      touched.insert(contact.session_id);
    msg::ForceCommand command;
    while (commands.take(command)) {
      commanded.insert(command.session_id);
      last_command = command;
      if (command.session_id != over && command.sequence_number < 5)
        first_force = std::max(first_force, force(command));
    }
  }
  /// Latched samples may be written again for a late reader.
  static void note(std::vector<std::uint64_t>& sessions, std::uint64_t session) {
    if (sessions.empty() || sessions.back() != session)
      sessions.push_back(session);
  }
  bool sees(const std::function<bool()>& holds) {
    return wait_until([&] {
      poll();
      return holds();
    });
  }
  static const qos::Profile& latched() { return qos::profile(qos::ProfileId::kLatched); }
  static const qos::Profile& tap() { return qos::profile(qos::ProfileId::kTap); }

  bus::Participant participant;
  runtime::NodeRegistry registry;
  bus::Reader<msg::DeviceDescription> descriptions;
  bus::Reader<msg::ScenePlan> plans;
  bus::Reader<msg::CouplingDesign> designs;
  bus::Reader<msg::DeviceState> states;
  bus::Reader<msg::ContactState> contacts;
  bus::Reader<msg::ForceCommand> commands;
  std::vector<std::uint64_t> described, planned, designed;
  std::set<std::uint64_t> touched, commanded;
  msg::DeviceState newest{};
  msg::ForceCommand last_command{};
  double first_force = 0.0;
  std::uint64_t over = 0;  ///< session that has ended
};

/// Options live as long as the thread that uses them.
template <class Options>
struct Node {
  Node(Options o, int (*run)(const Options&, const std::atomic<bool>&))
      : options(std::move(o)),
        thread([this, run](const std::atomic<bool>& stop) { return run(options, stop); }) {}
  Options options;
  NodeThread thread;
};

device_node::Options device_options(const std::string& rig, double duration_s) {
  auto options = node_options<device_node::Options>(rig, "plane");
  options.motion = "hit";
  options.duration_s = duration_s;
  return options;
}

/// A logger as the device sees it, with enough space for the test.
struct DeviceLogger {
  explicit DeviceLogger(const std::string& rig)
      : node(kDomain, "logger", rig),
        states(node.participant, qos::kDeviceState, rig, deep_tap()),
        descriptions(node.participant, qos::kDeviceDescription, rig, Bystander::latched()) {
    node.say(0);
  }
  static const qos::Profile& deep_tap() {
    static const qos::Profile profile = [] {
      qos::Profile tap = Bystander::tap();
      tap.depth = 20'000;
      return tap;
    }();
    return profile;
  }
  std::optional<std::uint64_t> first() {
    msg::DeviceState state;
    while (states.take(state))
      if (!number)
        number = state.sequence_number;
    return number;
  }
  StandIn node;
  bus::Reader<msg::DeviceState> states;
  bus::Reader<msg::DeviceDescription> descriptions;
  std::optional<std::uint64_t> number;
};

device_node::Options with_logger(const std::string& rig) {
  auto options = device_options(rig, 0.0);
  options.rig_is_checked = true;
  options.peers = {"logger"};
  return options;
}

TEST(FirstSample, OfASimulatedDeviceIsReadByItsPeers) {
  const std::string rig = own_rig("f");
  Node device(with_logger(rig), device_node::run);
  std::this_thread::sleep_for(milliseconds(1500));
  DeviceLogger logger(rig);
  ASSERT_TRUE(wait_until([&] { return logger.first().has_value(); })) << device.thread.error();
  EXPECT_EQ(*logger.first(), 0U);
}

TEST(FirstSample, IsWrittenAfterFiveSecondsWithoutThem) {
  const std::string rig = own_rig("p");
  Bystander bystander(rig);
  const auto begin = std::chrono::steady_clock::now();
  Node device(with_logger(rig), device_node::run);
  ASSERT_TRUE(bystander.sees([&] { return bystander.newest.session_id != 0; }))
      << device.thread.error();
  EXPECT_GT(std::chrono::steady_clock::now() - begin, milliseconds(5000));
}

TEST(Readiness, ForADeviceIsReportedOnceThePeersHaveMatched) {
  const std::string rig = own_rig("y");
  StandIn node(kDomain, "rendering", rig);
  runtime::NodeRegistry registry(node.participant, rig);
  bus::Writer<msg::ContactState> contacts(node.participant, qos::kContactState, rig,
                                          qos::profile(qos::ProfileId::kStream));
  bus::Reader<msg::DeviceState> states(node.participant, qos::kDeviceState, rig, Bystander::tap());
  runtime::NodeOptions options;
  options.peers = {"logger"};
  const std::vector<runtime::Link> links = {runtime::link_of_writer(qos::kContactState, contacts),
                                            runtime::link_of_reader(qos::kDeviceState, states)};
  runtime::Session session;
  runtime::NodeReport report;
  const auto state = [&] {
    registry.update();
    session.report_to(report, options, registry, links, "a device", false);
    return report.state;
  };
  EXPECT_EQ(state(), runtime::NodeState::kStarting);
  StandIn logger(kDomain, "logger", rig);
  logger.say(0);
  ASSERT_TRUE(wait_until([&] { return state(), registry.find("logger").has_value(); }));
  EXPECT_EQ(state(), runtime::NodeState::kStarting) << "it does not read the contacts";
  bus::Reader<msg::ContactState> its(logger.participant, qos::kContactState, rig, Bystander::tap());
  ASSERT_TRUE(wait_until([&] { return state() == runtime::NodeState::kReady; }));
  EXPECT_EQ(report.session_id, 0U) << "no device is there, and none is waited for";
  session.begin(7);
  EXPECT_EQ(state(), runtime::NodeState::kReady);
  EXPECT_EQ(report.session_id, 7U);
}

TEST(Session, OfARestartedDeviceIsNewAndResetsTheNodes) {
  const std::string rig = own_rig();
  Bystander bystander(rig);
  Node rendering(node_options<rendering_node::Options>(rig, "plane"), rendering_node::run);
  Node coupling(node_options<coupling_node::Options>(rig, "plane"), coupling_node::run);
  std::uint64_t old_session = 0;
  msg::ForceCommand old_command{};
  {
    Node device(device_options(rig, 2.0), device_node::run);
    ASSERT_TRUE(bystander.sees([&] { return device.thread.status() >= 0; }))
        << device.thread.error();
    EXPECT_EQ(device.thread.status(), 0);
    old_session = bystander.newest.session_id;
    old_command = bystander.last_command;
    ASSERT_NE(old_session, 0U);
    EXPECT_EQ(bystander.commanded, (std::set<std::uint64_t>{old_session}));
  }
  bystander.touched.clear(), bystander.commanded.clear(), bystander.first_force = 0.0,
                                                          bystander.over = old_session;
  Node device(device_options(rig, 2.0), device_node::run);
  ASSERT_TRUE(bystander.sees([&] { return !bystander.commanded.empty(); }))
      << device.thread.error();
  // An unauthorised participant repeats a command of the old session: refused and counted, and it
  // does not replace the coupling.
  bus::Writer<msg::ForceCommand> repeater(bystander.participant, qos::kForceCommand, rig,
                                          qos::profile(qos::ProfileId::kStream));
  ASSERT_TRUE(wait_until([&] { return repeater.matched_count() >= 1; }));
  for (int i = 0; i < 200; ++i) {
    old_command.sequence_number = bystander.newest.sequence_number;
    old_command.valid_until_ns = std::numeric_limits<std::int64_t>::max();
    old_command.wrench.force.x = 8.0;
    repeater.write(old_command);
    bystander.poll();
    std::this_thread::sleep_for(milliseconds(2));
  }
  double foreign = -1.0, largest = 0.0;
  ASSERT_TRUE(bystander.sees([&] {
    if (const auto report = bystander.registry.find("device")) {
      foreign = report->figures.at("foreign_commands").value;
      largest = report->figures.at("max_force_n").value;
    }
    return device.thread.status() >= 0;
  }));
  EXPECT_EQ(device.thread.status(), 0);
  EXPECT_GT(foreign, 20.0);
  EXPECT_LT(largest, 2.0) << "the old session's 8 N reached the device";
  ASSERT_EQ(bystander.described.size(), 2U);
  const std::uint64_t new_session = bystander.described[1];
  EXPECT_NE(new_session, old_session);
  EXPECT_EQ(bystander.planned, bystander.described);
  EXPECT_EQ(bystander.designed, bystander.described);
  EXPECT_EQ(bystander.touched, (std::set<std::uint64_t>{new_session}));
  EXPECT_EQ(bystander.commanded, (std::set<std::uint64_t>{new_session, old_session}))
      << "the repeater's and the coupling's";
  EXPECT_EQ(bystander.first_force, 0.0) << "a new session begins at rest";
  EXPECT_EQ(coupling.thread.end(), 0);
  EXPECT_EQ(rendering.thread.end(), 0);
}

TEST(Session, IsNewInLockstepToo) {
  const std::string rig = own_rig();
  Bystander bystander(rig);
  const auto lockstep = [](auto options) {
    options.lockstep = true;
    options.peers = {"rendering", "coupling"};
    return options;
  };
  Node rendering(lockstep(node_options<rendering_node::Options>(rig, "plane")),
                 rendering_node::run);
  Node coupling(lockstep(node_options<coupling_node::Options>(rig, "plane")), coupling_node::run);
  for (int i = 0; i < 2; ++i) {
    Node device(lockstep(device_options(rig, 0.5)), device_node::run);
    ASSERT_TRUE(bystander.sees([&] { return device.thread.status() >= 0; }))
        << device.thread.error();
    EXPECT_EQ(device.thread.status(), 0);
    ASSERT_TRUE(bystander.sees([&] { return !bystander.registry.find("device"); }));
  }
  ASSERT_EQ(bystander.described.size(), 2U);
  EXPECT_NE(bystander.described[0], bystander.described[1]);
  EXPECT_EQ(bystander.planned, bystander.described);
  EXPECT_EQ(bystander.commanded,
            (std::set<std::uint64_t>{bystander.described[0], bystander.described[1]}));
}

/// The messages of a device, without one.
class FakeDevice : public StandIn {
 public:
  FakeDevice(const std::string& rig)
      : StandIn(kDomain, "device", rig),
        descriptions(participant, qos::kDeviceDescription, rig, Bystander::latched()),
        states(participant, qos::kDeviceState, rig, qos::profile(qos::ProfileId::kStream)) {}
  void describe(std::uint64_t session) {
    descriptions.write(stylus(session));
    say(session);
  }
  void sample(std::uint64_t session, std::uint64_t sequence, double height,
              std::uint32_t flags = 0) {
    msg::DeviceState m{};
    m.session_id = session;
    m.sequence_number = sequence;
    m.sample_time_ns = static_cast<std::int64_t>(sequence) * 1'000'000;
    m.pose.position = {0.003, 0.002, height};
    m.pose.orientation.w = 1.0;
    m.flags = flags;
    states.write(m);
  }
  bus::Writer<msg::DeviceDescription> descriptions;
  bus::Writer<msg::DeviceState> states;
};

class RenderingAlone : public testing::Test {
 protected:
  RenderingAlone()
      : rig(own_rig()),
        device(rig),
        contacts(device.participant, qos::kContactState, rig, qos::profile(qos::ProfileId::kTap)),
        plans(device.participant, qos::kScenePlan, rig, Bystander::latched()),
        rendering(node_options<rendering_node::Options>(rig, "plane"), rendering_node::run) {}
  void begin(std::uint64_t session) {
    device.describe(session);
    ASSERT_TRUE(wait_until([&] {
      bool planned = false;
      plans.take_each([&](const msg::ScenePlan& plan) {
        planned |= plan.session_id == session;
        most_n_per_m = plan.all_points_stiffness_n_per_m,
        most_nm_per_rad = plan.all_points_stiffness_nm_per_rad;
        one_n_per_m = plan.one_point_stiffness_n_per_m,
        one_nm_per_rad = plan.one_point_stiffness_nm_per_rad;
        points = plan.shell_points;
      });
      return planned && device.states.matched_count() == 1 && contacts.matched_count() == 1;
    }));
  }
  msg::ContactState contact_of(std::uint64_t session, std::uint64_t sequence, double height,
                               std::uint32_t flags = 0) {
    msg::ContactState contact{};
    EXPECT_TRUE(wait_until([&] {
      device.sample(session, sequence, height, flags);
      std::this_thread::sleep_for(milliseconds(2));
      while (contacts.take(contact))
        if (contact.session_id == session && contact.sequence_number == sequence)
          return true;
      return false;
    }));
    std::this_thread::sleep_for(milliseconds(5));
    msg::ContactState repeated{};
    while (contacts.take(repeated)) {
    }
    return contact;
  }
  std::string rig;
  FakeDevice device;
  bus::Reader<msg::ContactState> contacts;
  bus::Reader<msg::ScenePlan> plans;
  Node<rendering_node::Options> rendering;
  double most_n_per_m = 0.0, most_nm_per_rad = 0.0, one_n_per_m = 0.0,
         one_nm_per_rad = 0.0;  ///< of the last plan
  std::uint64_t points = 0;
};

constexpr double kInContact = 0.009, kNotANumber = std::numeric_limits<double>::quiet_NaN();

TEST_F(RenderingAlone, HoldsAContactForThreeRefusedSamples) {
  begin(1);
  const double good = force(contact_of(1, 0, kInContact));
  ASSERT_GT(good, 0.01);
  std::vector<double> repeated;
  for (std::uint64_t i = 1; i <= 6; ++i) {
    const msg::ContactState c = contact_of(1, i, kNotANumber);
    EXPECT_NE(c.flags & msg::contact_state::kFlagRefusedSample, 0U);
    repeated.push_back(force(c));
  }
  EXPECT_EQ(repeated.front(), good);
  EXPECT_EQ(repeated.back(), 0.0);
  EXPECT_EQ(force(contact_of(1, 7, kInContact)), good);
}

TEST_F(RenderingAlone, ReportsItsStiffnessAndItsMaximum) {
  begin(1);
  EXPECT_EQ(one_n_per_m, 30.0);
  EXPECT_EQ(most_n_per_m, 30.0 * static_cast<double>(points));
  EXPECT_NEAR(one_nm_per_rad, 30.0 * 0.01 * 0.01, 3e-4) << "a sphere of 10 mm, 30 N/m a point";
  EXPECT_NEAR(most_nm_per_rad, static_cast<double>(points) * 2.0 / 3.0 * one_nm_per_rad,
              0.1 * most_nm_per_rad);
  const msg::ContactState contact = contact_of(1, 0, kInContact);
  const Mat6 stiffness = runtime::from_msg(contact.stiffness);
  EXPECT_NEAR((stiffness.topLeftCorner<3, 3>().trace()), contact.stiffness_bound_n_per_m, 1e-9);
  EXPECT_GT(contact.stiffness_bound_n_per_m, 0.0);
  EXPECT_GT(stiffness(3, 3), 0.0);
  EXPECT_LE(stiffness(3, 3), most_nm_per_rad);
}

TEST_F(RenderingAlone, RefusesAPoseThatTheDeviceDoesNotTrust) {
  begin(1);
  ASSERT_GT(force(contact_of(1, 0, kInContact)), 0.01);
  msg::ContactState c{};
  for (std::uint64_t i = 1; i <= 6; ++i)
    c = contact_of(1, i, kInContact, msg::device_state::kFlagPoseLatched);
  EXPECT_NE(c.flags & msg::contact_state::kFlagRefusedSample, 0U);
  EXPECT_EQ(force(c), 0.0) << "the last good pose would push for ever";
}

TEST_F(RenderingAlone, HoldsNoContactOfAnotherSession) {
  begin(1);
  ASSERT_GT(force(contact_of(1, 0, kInContact)), 0.01);
  begin(2);
  EXPECT_EQ(force(contact_of(2, 0, kNotANumber)), 0.0);
}

TEST(Rigs, OnOneDomainAreIsolated) {
  const std::string left = own_rig("left"), right = own_rig("right");
  Bystander at_left(left), at_right(right);
  Node left_rendering(node_options<rendering_node::Options>(left, "plane"), rendering_node::run);
  Node right_rendering(node_options<rendering_node::Options>(right, "plane"), rendering_node::run);
  Node left_coupling(node_options<coupling_node::Options>(left, "plane"), coupling_node::run);
  Node right_coupling(node_options<coupling_node::Options>(right, "plane"), coupling_node::run);
  Node left_device(device_options(left, 1.5), device_node::run);
  Node right_device(device_options(right, 1.5), device_node::run);
  ASSERT_TRUE(wait_until([&] {
    at_left.poll(), at_right.poll();
    return left_device.thread.status() >= 0 && right_device.thread.status() >= 0;
  }));
  EXPECT_EQ(left_device.thread.status(), 0) << left_device.thread.error();
  EXPECT_EQ(right_device.thread.status(), 0) << right_device.thread.error();
  ASSERT_EQ(at_left.described.size(), 1U);
  ASSERT_EQ(at_right.described.size(), 1U);
  EXPECT_NE(at_left.described[0], at_right.described[0]);
  for (const Bystander* side : {&at_left, &at_right}) {
    const std::set<std::uint64_t> own{side->described[0]};
    EXPECT_EQ(side->touched, own);
    EXPECT_EQ(side->commanded, own);
    EXPECT_EQ(side->planned, side->described);
    EXPECT_EQ(side->designed, side->described);
  }
}

TEST(Rigs, KeepOneOfTwoDevicesThatStartAtTheSameTime) {
  const std::string rig = own_rig();
  Node first(device_options(rig, 3.0), device_node::run);
  Node second(device_options(rig, 3.0), device_node::run);
  const int a = first.thread.wait(), b = second.thread.wait();
  EXPECT_EQ(std::min(a, b), 0) << first.thread.error() << second.thread.error();
  EXPECT_EQ(std::max(a, b), 1);
}

TEST(Rigs, AfterASplitTheBusierDeviceStays) {
  const std::string rig = own_rig();
  Bystander bystander(rig);
  Node rendering(node_options<rendering_node::Options>(rig, "plane"), rendering_node::run);
  Node coupling(node_options<coupling_node::Options>(rig, "plane"), coupling_node::run);
  Node device(device_options(rig, 0.0), device_node::run);
  const auto figure = [&](const char* name) {
    const auto report = bystander.registry.find("device");
    return report ? runtime::value_of(report->figures, name) : 0.0;
  };
  ASSERT_TRUE(bystander.sees([&] { return figure("answered") > 500; })) << device.thread.error();
  constexpr char kClaim[] = "answered_before_conflict";
  {
    StandIn other(kDomain, "device",
                  rig);  // an earlier session by its number, as a slow clock would give it
    other.say(1, runtime::NodeState::kRunning, {{kClaim, {3, "samples"}}});
    ASSERT_TRUE(wait_until([&] {
      bystander.registry.update();
      for (const auto& report : bystander.registry.reports())
        if (report.figures.contains(kClaim) && report.session_id != 1)
          return true;
      return false;
    })) << "it does not say what it claims";
    std::this_thread::sleep_for(milliseconds(500));
    EXPECT_EQ(device.thread.status(), -1) << "the one that runs goes";
  }
  std::this_thread::sleep_for(milliseconds(100));
  StandIn other(kDomain, "device", rig);
  other.say(~std::uint64_t{0}, runtime::NodeState::kRunning, {{kClaim, {1e12, "samples"}}});
  EXPECT_TRUE(bystander.sees([&] { return device.thread.status() == 1; })) << "both run";
}

/// In a ring without `up`: a waiting node does not take the role within the session.
TEST(Rigs, ALostRenderingEndsTheSessionAtZeroForce) {
  const std::string rig = own_rig();
  Bystander bystander(rig);
  std::optional<Node<rendering_node::Options>> first;
  first.emplace(node_options<rendering_node::Options>(rig, "plane"), rendering_node::run);
  Node coupling(node_options<coupling_node::Options>(rig, "plane"), coupling_node::run);
  Node device(device_options(rig, 0.0), device_node::run);
  ASSERT_TRUE(bystander.sees([&] { return bystander.last_command.sequence_number > 200; }));
  Node second(node_options<rendering_node::Options>(rig, "plane"), rendering_node::run);
  ASSERT_TRUE(bystander.sees([&] {
    const auto report = bystander.registry.find("coupling");
    return report && report->message.find("are refused") != std::string::npos;
  })) << "the second one is not named";
  first->thread.end();
  EXPECT_TRUE(bystander.sees([&] { return device.thread.status() == 1; }))
      << "the session goes on without its rendering";
  EXPECT_EQ(coupling.thread.status(), -1) << "the coupling waits for another session";
  Node next(device_options(rig, 0.0), device_node::run);
  const std::uint64_t session = bystander.newest.session_id;
  EXPECT_TRUE(bystander.sees([&] {
    return bystander.newest.session_id != session &&
           bystander.last_command.session_id == bystander.newest.session_id;
  })) << "another session binds the rendering that is there";
}

TEST(Rigs, ALostCouplingEndsTheSessionAtZeroForce) {
  const std::string rig = own_rig();
  Bystander bystander(rig);
  Node rendering(node_options<rendering_node::Options>(rig, "plane"), rendering_node::run);
  Node coupling(node_options<coupling_node::Options>(rig, "plane"), coupling_node::run);
  Node device(device_options(rig, 0.0), device_node::run);
  ASSERT_TRUE(bystander.sees([&] { return bystander.last_command.sequence_number > 200; }));
  coupling.thread.end();
  EXPECT_TRUE(bystander.sees([&] { return device.thread.status() == 1; }));
}

}  // namespace
}  // namespace voxtouch::test
