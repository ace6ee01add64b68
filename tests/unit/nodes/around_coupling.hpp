#pragma once
/// Device and rendering of one rig, as a coupling node receives them, and its answers.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "core/types/geometry.hpp"
#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/coupling/coupling_node.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/strings.hpp"
#include "tests/support/stand_in.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::test::around_coupling {

using std::chrono::milliseconds;
inline constexpr double kDepth = 1e-3, kStiffness = 200.0, kForce = kStiffness * kDepth;

/// plane.yaml with another coupling, as a temporary file.
inline std::string scene_with(const std::string& coupling) {
  std::ifstream in(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
  std::string line, text;
  while (std::getline(in, line)) {
    if (line.starts_with("coupling:"))
      line = "coupling: " + coupling;
    if (const auto at = line.find("../meshes"); at != std::string::npos)
      line.replace(at, 9, std::string(VOXTOUCH_DEPLOY) + "/meshes");
    text += line + "\n";
  }
  const auto file = std::filesystem::temp_directory_path() /
                    ("coupling_node_test_" + std::to_string(getpid()) + ".yaml");
  std::ofstream(file) << text;
  return file.string();
}

struct Seen {
  std::string status, kind;
  double cutoff_hz = 0, displayed_n_per_m = 0, damping_ns_per_m = 0;
  std::size_t reasons = 0, notes = 0;
  std::uint64_t from_sample = 0;
  bool starts_at_rest = false, commands_force = false;
};

/// Device and rendering of one rig, as far as the coupling sees them.
class Around {
 public:
  /// `claimed`: the ring belongs to a `voxtouch up`, whose claim is to be written.
  explicit Around(const std::string& coupling, bool lockstep = false, bool claimed = false)
      : rig(own_rig("c")),
        device(kDomain, "device", rig),
        rendering(std::make_unique<StandIn>(kDomain, "rendering", rig)),
        participant({kDomain, "lo", "around"}),
        up(kDomain, rig),
        registry(participant, rig),
        descriptions(device.participant, qos::kDeviceDescription, rig, latched()),
        plans(rendering->participant, qos::kScenePlan, rig, latched()),
        contacts(rendering->participant, qos::kContactState, rig,
                 qos::profile(lockstep ? qos::ProfileId::kLockstep : qos::ProfileId::kStream)),
        designs(participant, qos::kCouplingDesign, rig, latched()),
        commands(participant, qos::kForceCommand, rig,
                 qos::profile(lockstep ? qos::ProfileId::kLockstep : qos::ProfileId::kTap)),
        options(options_for(coupling, lockstep, claimed)),
        node([this](const std::atomic<bool>& stop) { return coupling_node::run(options, stop); }) {
    EXPECT_TRUE(wait_until([&] {
      return descriptions.matched_count() && plans.matched_count() && contacts.matched_count() &&
             commands.matched_count() && designs.matched_count();
    }));
  }
  coupling_node::Options options_for(const std::string& coupling, bool lockstep,
                                     bool claimed) const {
    auto o = node_options<coupling_node::Options>(rig);
    o.lockstep = lockstep;
    if (claimed)
      o.up = up.participant.guid();
    o.scene = scene_with(coupling);
    return o;
  }
  static const qos::Profile& latched() { return qos::profile(qos::ProfileId::kLatched); }
  static const qos::Profile& stream() { return qos::profile(qos::ProfileId::kStream); }

  void describe(double damping_ns_per_m, std::uint64_t session = 7, double mass_kg = 0.05) {
    msg::DeviceDescription m = stylus(session);
    m.mass_min_kg = mass_kg, m.mass_max_kg = 2.0 * mass_kg;
    m.damping_ns_per_m = damping_ns_per_m;
    descriptions.write(m);
    device.say(session);
  }
  void describe_one_that_gives_torque() {
    msg::DeviceDescription m = stylus(7);
    m.damping_ns_per_m = 20.0;
    m.max_torque_nm = 1.0, m.max_torque_rate_nm_per_s = 1e3, m.max_stiffness_nm_per_rad = 10.0;
    m.inertia_min_kg_m2 = 1e-3, m.inertia_max_kg_m2 = 2e-3, m.damping_nms_per_rad = 0.2;
    descriptions.write(m);
    device.say(7);
  }
  /// Requirements of the effects, in addition to the contact.
  struct Demand {
    double damping_ns_per_m, least_n_per_m;
    std::string torque;
    double damping_nms_per_rad = 0.0;
    double external_force_n = 0.0;
  };
  void plan(double one_point_n_per_m = 30.0, std::uint64_t session = 7) {
    plan(one_point_n_per_m, session, {0.0, 0.0, ""});
  }
  void plan(double one_point_n_per_m, std::uint64_t session, const Demand& demand) {
    plans.write(message_of(one_point_n_per_m, session, demand));
    rendering->say(session);
  }
  /// `demand` has to live as long as the message.
  static msg::ScenePlan message_of(double one_point_n_per_m, std::uint64_t session,
                                   const Demand& demand) {
    static const std::string text = "plane", oil = "oil", none;
    msg::ScenePlan m{};
    m.session_id = session;
    m.scene = m.scene_hash = m.contact_model = runtime::lend(text);
    m.one_point_stiffness_n_per_m = one_point_n_per_m;
    m.all_points_stiffness_n_per_m = 100 * one_point_n_per_m;
    m.one_point_stiffness_nm_per_rad = 1e-4 * one_point_n_per_m,
    m.all_points_stiffness_nm_per_rad = 1e-2 * one_point_n_per_m;
    m.effects_damping_ns_per_m = m.largest_damping_ns_per_m = demand.damping_ns_per_m;
    m.least_stiffness_n_per_m = demand.least_n_per_m;
    m.largest_damping = m.stiffest = runtime::lend(oil),
    m.largest_damping_place = runtime::lend(none);
    m.effects_damping_nms_per_rad = m.largest_damping_nms_per_rad = demand.damping_nms_per_rad;
    m.largest_rotation_damping = runtime::lend(oil),
    m.largest_rotation_damping_place = runtime::lend(none);
    m.torque_effect = runtime::lend(demand.torque);
    static const std::string hand = "remote";
    m.external_force_n = demand.external_force_n;
    m.external_effect = runtime::lend(demand.external_force_n != 0.0 ? hand : none),
    m.external_place = runtime::lend(none);
    return m;
  }
  /// Force stops within some samples, and the node reports the reason; `text` is part of its
  /// sentence.
  void expect_no_force(const std::string& text) {
    EXPECT_TRUE(wait_until([&] {
      touch();
      return message().find("No force") != std::string::npos;
    })) << message();
    EXPECT_NE(message().find(text), std::string::npos) << message();
    for (int i = 0; i < 20; ++i)
      touch();
    forces.clear();
    for (int i = 0; i < 100; ++i)
      touch();
    EXPECT_TRUE(forces.empty());
  }
  bool force_comes() {
    forces.clear();
    return wait_until([&] {
      touch();
      return !forces.empty() && forces.back() > 0.2 * kForce;
    });
  }
  /// Pressed against a floor at one depth, sample after sample.
  void touch(std::uint64_t session = 7) { touch(-kDepth, kForce, session); }
  void touch(double z_m, double force_n, std::uint64_t session = 7) {
    msg::ContactState c{};
    c.session_id = session;
    c.sequence_number = sequence++;
    c.sample_time_ns = static_cast<std::int64_t>(c.sequence_number) * 1'000'000;
    c.tool_pose = runtime::to_msg(Pose{Vec3(0, 0, z_m), Quat::Identity()});
    c.wrench.force.z = force_n;
    c.stiffness_bound_n_per_m = kStiffness;
    Mat6 stiffness = Mat6::Zero();
    stiffness(2, 2) = kStiffness;
    runtime::to_msg(stiffness, c.stiffness);
    contacts.write(c);
    std::this_thread::sleep_for(milliseconds(1));
    poll();
  }
  /// The same in lockstep, with its answer. The node computes the coupling of each contact,
  /// whatever the load of the machine. In real time it skips contacts that a newer one has
  /// replaced.
  [[nodiscard]] bool answers(double z_m = -kDepth, double force_n = kForce) {
    const std::size_t before = forces.size();
    touch(z_m, force_n);
    return wait_until([&] {
      poll();
      return forces.size() > before;
    });
  }
  void poll() {
    msg::ForceCommand command;
    while (commands.take(command))
      forces.push_back(command.wrench.force.z);
    designs.take_each([this](const msg::CouplingDesign& d) {
      seen.push_back({d.status, d.kind, d.cutoff_hz, d.displayed_stiffness_n_per_m,
                      d.injected_damping_ns_per_m, d.reasons._length, d.notes._length,
                      d.from_sample, d.starts_at_rest, d.commands_force});
      for (std::uint32_t n = 0; n < d.notes._length; ++n)
        notes.emplace_back(d.notes._buffer[n]);
    });
  }
  std::string message() {
    registry.update();
    const auto report = registry.find("coupling");
    return report ? report->message : "";
  }

  std::string rig;
  StandIn device;
  std::unique_ptr<StandIn> rendering;
  bus::Participant participant;
  StandInUp up;
  runtime::NodeRegistry registry;
  bus::Writer<msg::DeviceDescription> descriptions;
  bus::Writer<msg::ScenePlan> plans;
  bus::Writer<msg::ContactState> contacts;
  bus::Reader<msg::CouplingDesign> designs;
  bus::Reader<msg::ForceCommand> commands;
  coupling_node::Options options;
  NodeThread node;
  std::uint64_t sequence = 0;
  std::vector<double> forces;
  std::vector<Seen> seen;
  std::vector<std::string> notes;  ///< of all designs
};

}  // namespace voxtouch::test::around_coupling
