// A ring in contact, in real time, and an unauthorised writer of its messages: none of them is
// displayed, and the writer is named.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "nodes/bus/followed_reader.hpp"
#include "nodes/coupling/coupling_node.hpp"
#include "nodes/device/device_node.hpp"
#include "nodes/rendering/rendering_node.hpp"
#include "tests/support/adversary.hpp"
#include "tests/support/stand_in.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kMark = 0.0987;  ///< [m], never reached by the tool; marks an attack

/// plane.yaml with a hand that presses after a moment and stays.
std::string pressing_scene() {
  std::ifstream in(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
  std::stringstream text;
  text << in.rdbuf();
  std::string scene = text.str();
  const auto replace = [&](const std::string& from, const std::string& to) {
    EXPECT_NE(scene.find(from), std::string::npos) << "plane.yaml has no '" << from << "'";
    for (std::size_t at = 0; (at = scene.find(from, at)) != std::string::npos; at += to.size())
      scene.replace(at, from.size(), to);
  };
  replace("../meshes", std::string(VOXTOUCH_DEPLOY) + "/meshes");
  replace("hold_s: 2.6, repeat_from: 0", "hold_s: 0.2");
  const auto file = std::filesystem::temp_directory_path() /
                    ("adversary_test_" + std::to_string(getpid()) + ".yaml");
  std::ofstream(file) << scene;
  return file.string();
}

template <class Options>
struct Node {
  Node(Options o, int (*run)(const Options&, const std::atomic<bool>&))
      : options(std::move(o)),
        thread([this, run](const std::atomic<bool>& stop) { return run(options, stop); }) {}
  Options options;
  NodeThread thread;
};

class Attacked : public testing::Test {
 protected:
  Attacked()
      : registry(listener, rig),
        contacts(listener, qos::kContactState, rig, stream()),
        commands(listener, qos::kForceCommand, rig, stream()),
        states(listener, qos::kDeviceState, rig, stream()),
        rendering(options<rendering_node::Options>(), rendering_node::run),
        coupling(options<coupling_node::Options>(), coupling_node::run) {}
  static const qos::Profile& stream() { return qos::profile(qos::ProfileId::kStream); }
  template <class Options>
  Options options() const {
    auto o = node_options<Options>(rig);
    o.scene = scene;
    return o;
  }
  void start_device() {
    auto o = options<device_node::Options>();
    o.motion = "hit";
    device.emplace(std::move(o), device_node::run);
  }
  /// Receives from the ring's nodes only.
  void poll() {
    registry.update();
    follow("rendering", contacts);
    follow("coupling", commands);
    follow("device", states);
    msg::ContactState contact;
    while (contacts.take(contact))
      newest_contact = contact, marked += contact.tool_pose.position.x == kMark;
    msg::ForceCommand command;
    while (commands.take(command)) {
      newest_command = command;
      last_force = command.wrench.force.z;
      largest_force = std::max(largest_force, std::abs(last_force));
    }
    msg::DeviceState state;
    while (states.take(state))
      newest_state = state;
  }
  template <class Reader>
  void follow(const std::string& role, Reader& reader) {
    if (reader.writer() != 0)
      return;
    for (const auto& report : registry.reports())
      if (report.node == role && report.pid == static_cast<std::uint32_t>(getpid()))
        reader.following().follow(report.participant);
  }
  bool sees(const std::function<bool()>& holds, milliseconds patience = std::chrono::seconds(15)) {
    return wait_until([&] { return poll(), holds(); }, patience);
  }
  const runtime::NodeReport* report_of(const std::string& role) {
    for (const auto& report : registry.reports())
      if (report.node == role && report.host != "elsewhere")
        return &(last_report = report);
    return nullptr;
  }
  double number(const std::string& role, const std::string& name) {
    const auto* report = report_of(role);
    return report && report->figures.contains(name) ? report->figures.at(name).value : -1.0;
  }
  bool says(const std::string& role, const std::string& words) {
    const auto* report = report_of(role);
    return report && report->message.find(words) != std::string::npos;
  }
  /// Waits until the hand has pressed for a while; the force at that time is the reference.
  void until_it_presses() {
    ASSERT_TRUE(sees([&] {
      return newest_state.sequence_number > 1500 && number("device", "max_force_n") > 0.05;
    }));
    ASSERT_TRUE(sees([&] {
      return newest_state.sequence_number > 2700;
    }));  // its status has reported all of that
    device_force = number("device", "max_force_n");
    commanded = largest_force, steady = last_force;
    ASSERT_GT(std::abs(steady), 0.05);
    session = newest_state.session_id;
    ASSERT_LT(device_force, 3.0);
  }
  /// Calls `write` about a thousand times a second for a while; afterwards none of it may have been
  /// displayed.
  void attack(const std::string& what, const std::function<void(Adversary&)>& write,
              const std::string& naming_participant) {
    SCOPED_TRACE(what);
    const std::uint64_t before = newest_state.sequence_number;
    Adversary adversary(kDomain, rig);
    const auto until = std::chrono::steady_clock::now() + milliseconds(700);
    while (std::chrono::steady_clock::now() < until) {
      poll();
      write(adversary);
      std::this_thread::sleep_for(milliseconds(1));
    }
    if (!naming_participant.empty()) {
      EXPECT_TRUE(sees([&] { return write(adversary), says(naming_participant, "are refused"); },
                       std::chrono::seconds(5)))
          << (report_of(naming_participant) ? last_report.message : "no report");
    }
    EXPECT_TRUE(sees([&] { return newest_state.sequence_number > before + 900; }))
        << "the run does not go on";
    EXPECT_LE(number("device", "max_force_n"), 1.15 * device_force + 0.05);
    EXPECT_LE(largest_force, 1.15 * commanded + 0.05) << "of the coupling's own commands";
    EXPECT_TRUE(sees([&] { return std::abs(last_force - steady) < 0.05 * std::abs(steady); },
                     std::chrono::seconds(3)))
        << "the contact is not displayed as before: " << last_force << " N, not " << steady << " N";
    EXPECT_EQ(marked, 0) << "foreign samples reached the rendering";
    EXPECT_EQ(number("coupling", "designs"), 1.0);
    EXPECT_EQ(device->thread.status(), -1);
  }
  /// The writer has left, and none is named.
  void expect_silence() {
    EXPECT_TRUE(sees([&] {
      return !says("device", "refused") && !says("coupling", "refused") &&
             !says("rendering", "refused");
    })) << last_report.message;
  }

  const std::string rig = own_rig("a"), scene = pressing_scene();
  bus::Participant listener{{kDomain, "lo", "listener"}};
  runtime::NodeRegistry registry;
  bus::FollowedReader<msg::ContactState> contacts;
  bus::FollowedReader<msg::ForceCommand> commands;
  bus::FollowedReader<msg::DeviceState> states;
  Node<rendering_node::Options> rendering;
  Node<coupling_node::Options> coupling;
  std::optional<Node<device_node::Options>> device;
  runtime::NodeReport last_report;
  msg::ContactState newest_contact{};
  msg::ForceCommand newest_command{};
  msg::DeviceState newest_state{};
  double last_force = 0.0, largest_force = 0.0, device_force = 0.0, commanded = 0.0, steady = 0.0;
  std::uint64_t session = 0;
  int marked = 0;
};

msg::ScenePlan false_plan(std::uint64_t session) {
  static char text[] = "plane";
  msg::ScenePlan plan{};
  plan.session_id = session;
  plan.scene = plan.scene_hash = plan.contact_model = text;
  plan.one_point_stiffness_n_per_m = plan.all_points_stiffness_n_per_m = 0.5;
  return plan;
}

TEST_F(Attacked, ForeignSamplesAreIgnoredAndTheirSenderNamed) {
  start_device();
  until_it_presses();
  const auto contact = [&](double stiffness) {
    return [this, stiffness](Adversary& a) {
      msg::ContactState c = newest_contact;
      ++c.sequence_number, c.sample_time_ns += 1'000'000;
      c.wrench.force.z = 8.0, c.stiffness_bound_n_per_m = stiffness;
      a.write(c);
    };
  };
  attack("contacts", contact(30.0), "coupling");
  attack("contacts without stiffness", contact(0.0), "coupling");
  attack(
      "device samples",
      [&](Adversary& a) {
        msg::DeviceState s = newest_state;
        ++s.sequence_number, s.sample_time_ns += 1'000'000;
        s.pose.position = {kMark, 0.0, 0.0};
        a.write(s);
      },
      "rendering");
  attack(
      "commands",
      [&](Adversary& a) {
        msg::ForceCommand c = newest_command;
        c.sequence_number = newest_state.sequence_number;
        c.sample_time_ns = newest_state.sample_time_ns,
        c.valid_until_ns = std::numeric_limits<std::int64_t>::max();
        c.wrench.force.z = 8.0;
        a.write(c);
      },
      "device");
  attack(
      "a false mass",
      [&](Adversary& a) {
        msg::DeviceDescription d = stylus(session);
        d.mass_min_kg = 50.0, d.mass_max_kg = 90.0;
        a.write(d);
      },
      "coupling");
  attack(
      "a description of NaN, of another session",
      [&](Adversary& a) {
        msg::DeviceDescription d = stylus(session + 1);
        d.mass_min_kg = d.max_force_n = kNan;
        a.write(d);
      },
      "rendering");
  attack(
      "a plan", [&](Adversary& a) { a.write(false_plan(session)); }, "coupling");
  attack(
      "statuses of its own",
      [&](Adversary& a) {
        a.claim("device", session), a.claim("rendering", session), a.claim("coupling", session);
      },
      "");
  const auto real = registry.reports();
  attack(
      "statuses in the others' names",
      [&](Adversary& a) {
        for (const auto& report : real)
          a.claim(report.node, report.session_id + 1, msg::node_status::kStateFailed,
                  report.participant);
      },
      "");
  expect_silence();
}

TEST_F(Attacked, BagOfAnotherSessionDoesNotStopTheRun) {
  start_device();
  until_it_presses();
  const std::uint64_t old = 12345;
  bus::Guid gone{};
  gone[0] = 7;
  attack(
      "ros2 bag play",
      [&](Adversary& a) {
        for (const char* role : {"device", "rendering", "coupling"})
          a.claim(role, old, msg::node_status::kStateRunning, gone);
        a.write(stylus(old)), a.write(false_plan(old));
        msg::DeviceState s = newest_state;
        msg::ContactState c = newest_contact;
        msg::ForceCommand f = newest_command;
        s.session_id = c.session_id = f.session_id = old;
        s.pose.position.x = kMark, c.wrench.force.z = f.wrench.force.z = 8.0;
        a.write(s), a.write(c), a.write(f);
      },
      "coupling");
  expect_silence();
}

TEST_F(Attacked, RingStartsUnderAttack) {
  Adversary adversary(kDomain, rig);
  NodeThread flood([&](const std::atomic<bool>& stop) {
    for (std::uint64_t i = 0; !stop.load(); ++i) {
      adversary.write(stylus(i)), adversary.write(false_plan(i));
      msg::DeviceState s{};
      s.sequence_number = i, s.pose.position.x = kMark, s.pose.orientation.w = 1.0;
      adversary.write(s);
      std::this_thread::sleep_for(milliseconds(1));
    }
    return 0;
  });
  start_device();
  until_it_presses();
  EXPECT_EQ(marked, 0);
  EXPECT_EQ(number("coupling", "designs"), 1.0);
  EXPECT_TRUE(sees([&] { return says("rendering", "are refused"); })) << last_report.message;
}

/// The same ring in lockstep, which waits for its own nodes alone.
TEST(LockstepAttacked, SilentNamesakeDoesNotStopTheRun) {
  const std::string rig = own_rig("l"), scene = pressing_scene();
  const auto in_lockstep = [&](auto options) {
    options.rig = rig, options.domain = kDomain, options.network_interface = "lo",
    options.scene = scene, options.lockstep = true;
    options.peers = {"rendering", "coupling"};
    return options;
  };
  auto of_device = in_lockstep(device_node::Options());
  of_device.motion = "hit";
  Node<rendering_node::Options> rendering(in_lockstep(rendering_node::Options()),
                                          rendering_node::run);
  Node<coupling_node::Options> coupling(in_lockstep(coupling_node::Options()), coupling_node::run);
  Node<device_node::Options> device(of_device, device_node::run);
  bus::Participant listener{{kDomain, "lo", "listener"}};
  runtime::NodeRegistry registry(listener, rig);
  const auto samples = [&] {
    registry.update();
    for (const auto& report : registry.reports())
      if (report.node == "device" && report.figures.contains("samples"))
        return report.figures.at("samples").value;
    return 0.0;
  };
  ASSERT_TRUE(wait_until([&] { return samples() > 100.0; }));
  std::uint64_t session = 0;
  for (const auto& report : registry.reports())
    session = std::max(session, report.session_id);
  std::vector<std::unique_ptr<Adversary>> silent;
  for (const char* name : {"rendering", "coupling"}) {
    silent.push_back(std::make_unique<Adversary>(kDomain, rig, qos::TimeMode::kLockstep));
    ASSERT_TRUE(
        wait_until([&] { return silent.back()->writer<msg::NodeStatus>().matched_count() >= 4; }));
    silent.back()->claim(name, session);
  }
  std::this_thread::sleep_for(std::chrono::seconds(7));
  const double before = samples();
  EXPECT_TRUE(wait_until([&] { return samples() > before + 100.0; }, std::chrono::seconds(3)));
  EXPECT_EQ(device.thread.status(), -1) << device.thread.error();
  EXPECT_EQ(rendering.thread.status(), -1);
  EXPECT_EQ(coupling.thread.status(), -1);
  coupling.thread.end();
  EXPECT_TRUE(wait_until([&] { return device.thread.status() == 1; }, std::chrono::seconds(3)))
      << "he has covered for the coupling, which is gone";
}

}  // namespace
}  // namespace voxtouch::test
