// The coupling node alone: what it designs, when it designs anew, and what it refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <sstream>
#include <utility>

#include "core/scene/scene_file.hpp"
#include "core/types/geometry.hpp"
#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/coupling/coupling_node.hpp"
#include "nodes/coupling/fitting.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/device_message.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/standby.hpp"
#include "nodes/runtime/strings.hpp"
#include "tests/support/stand_in.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds;
constexpr double kDepth = 1e-3, kStiffness = 200.0, kForce = kStiffness * kDepth;

/// plane.yaml with another coupling, as a file of its own.
std::string scene_with(const std::string& coupling) {
  std::ifstream in(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
  std::string line, text;
  while (std::getline(in, line)) {
    if (line.starts_with("coupling:")) line = "coupling: " + coupling;
    if (const auto at = line.find("../meshes"); at != std::string::npos)
      line.replace(at, 9, std::string(VOXTOUCH_DEPLOY) + "/meshes");
    text += line + "\n";
  }
  const auto file =
      std::filesystem::temp_directory_path() / ("coupling_node_test_" + std::to_string(getpid()) + ".yaml");
  std::ofstream(file) << text;
  return file.string();
}

struct Seen {
  std::string status, kind;
  double cutoff_hz = 0, shown_n_per_m = 0, damping_ns_per_m = 0;
  std::size_t reasons = 0, notes = 0;
};

/// Device and rendering of one rig, as far as the coupling sees them.
class Around {
 public:
  explicit Around(const std::string& coupling, bool lockstep = false, bool standby = false)
      : rig(own_rig("c")), device(kDomain, "device", rig), rendering(std::make_unique<StandIn>(kDomain, "rendering", rig)),
        participant({kDomain, "lo", "around"}), registry(participant, rig),
        descriptions(device.participant, qos::kDeviceDescription, rig, latched()),
        plans(rendering->participant, qos::kScenePlan, rig, latched()),
        contacts(rendering->participant, qos::kContactState, rig, qos::profile(lockstep ? qos::ProfileId::kLockstep : qos::ProfileId::kStream)),
        designs(participant, qos::kCouplingDesign, rig, latched()),
        commands(participant, qos::kForceCommand, rig, qos::profile(qos::ProfileId::kTap)),
        options(options_for(coupling, lockstep, standby)),
        node([this](const std::atomic<bool>& stop) { return coupling_node::run(options, stop); }) {
    EXPECT_TRUE(wait_until([&] {
      return descriptions.matched_count() && plans.matched_count() && contacts.matched_count() &&
             commands.matched_count() && designs.matched_count();
    }));
  }
  coupling_node::Options options_for(const std::string& coupling, bool lockstep, bool standby) const {
    auto o = node_options<coupling_node::Options>(rig);
    o.lockstep = lockstep;
    o.standby.is_standby = standby;
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
  /// What the effects demand, beside the contact.
  struct Demand {
    double damping_ns_per_m, least_n_per_m;
    std::string torque;
    double damping_nms_per_rad = 0.0;
    double external_force_n = 0.0;
  };
  void plan(double one_point_n_per_m = 30.0, std::uint64_t session = 7) { plan(one_point_n_per_m, session, {0.0, 0.0, ""}); }
  void plan(double one_point_n_per_m, std::uint64_t session, const Demand& demand) {
    plans.write(message_of(one_point_n_per_m, session, demand));
    rendering->say(session);
  }
  /// `demand` has to live as long as the message.
  static msg::ScenePlan message_of(double one_point_n_per_m, std::uint64_t session, const Demand& demand) {
    static const std::string text = "plane", oil = "oil", none;
    msg::ScenePlan m{};
    m.session_id = session;
    m.scene = m.scene_hash = m.contact_model = runtime::lend(text);
    m.one_point_stiffness_n_per_m = one_point_n_per_m;
    m.all_points_stiffness_n_per_m = 100 * one_point_n_per_m;
    m.one_point_stiffness_nm_per_rad = 1e-4 * one_point_n_per_m, m.all_points_stiffness_nm_per_rad = 1e-2 * one_point_n_per_m;
    m.effects_damping_ns_per_m = m.largest_damping_ns_per_m = demand.damping_ns_per_m;
    m.least_stiffness_n_per_m = demand.least_n_per_m;
    m.largest_damping = m.stiffest = runtime::lend(oil), m.largest_damping_place = runtime::lend(none);
    m.effects_damping_nms_per_rad = m.largest_damping_nms_per_rad = demand.damping_nms_per_rad;
    m.largest_turning_damping = runtime::lend(oil), m.largest_turning_damping_place = runtime::lend(none);
    m.torque_effect = runtime::lend(demand.torque);
    static const std::string hand = "remote";
    m.external_force_n = demand.external_force_n;
    m.external_effect = runtime::lend(demand.external_force_n != 0.0 ? hand : none), m.external_place = runtime::lend(none);
    return m;
  }
  /// Force stops within some samples, and the node says why; `text` stands in its sentence.
  void expect_no_force(const std::string& text) {
    EXPECT_TRUE(wait_until([&] {
      touch();
      return message().find("No force is commanded") != std::string::npos;
    })) << message();
    EXPECT_NE(message().find(text), std::string::npos) << message();
    for (int i = 0; i < 20; ++i) touch();
    forces.clear();
    for (int i = 0; i < 100; ++i) touch();
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
    look();
  }
  void look() {
    msg::ForceCommand command;
    while (commands.take(command)) forces.push_back(command.wrench.force.z);
    designs.take_each([this](const msg::CouplingDesign& d) {
      seen.push_back({d.status, d.kind, d.cutoff_hz, d.shown_stiffness_n_per_m, d.injected_damping_ns_per_m,
                      d.reasons._length, d.notes._length});
      for (std::uint32_t n = 0; n < d.notes._length; ++n) notes.emplace_back(d.notes._buffer[n]);
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

double largest_step(const std::vector<double>& forces) {
  double step = 0.0;
  for (std::size_t i = 1; i < forces.size(); ++i) step = std::max(step, std::abs(forces[i] - forces[i - 1]));
  return step;
}

TEST(CouplingNode, WaitsForDeviceAndPlanThenDesignsOnce) {
  Around around("{design: auto, kind: shaping_filter}");
  around.describe(2.0);
  std::this_thread::sleep_for(milliseconds(200));
  around.look();
  EXPECT_TRUE(around.seen.empty()) << "nothing is known of the contact yet";
  around.plan();
  ASSERT_TRUE(wait_until([&] {
    around.look();
    return !around.seen.empty();
  }));
  std::this_thread::sleep_for(milliseconds(200));
  around.look();
  ASSERT_EQ(around.seen.size(), 1U);
  EXPECT_NE(around.seen[0].status, "infeasible");
  EXPECT_EQ(around.seen[0].kind, "shaping_filter");
  EXPECT_GT(around.seen[0].shown_n_per_m, 50.0);
  for (int i = 0; i < 600; ++i) around.touch();
  ASSERT_FALSE(around.forces.empty());
  EXPECT_GT(around.forces.back(), 0.5 * kForce);
  EXPECT_EQ(around.node.end(), 0);
}

TEST(CouplingNode, DesignsAnewWithoutAForceStepWhenTheDeviceOrTheContactChange) {
  Around around("{design: auto, kind: shaping_filter}");
  around.describe(20.0);
  around.plan();
  ASSERT_TRUE(wait_until([&] {
    around.look();
    return around.seen.size() == 1;
  }));
  for (int i = 0; i < 800; ++i) around.touch();
  ASSERT_NEAR(around.forces.back(), kForce, 0.02 * kForce) << "nothing to cap yet";
  around.forces.clear();
  around.describe(0.05);  // it has lost its damping: less can be shown, and damping must be injected
  for (int i = 0; i < 200 || (around.seen.size() < 2 && i < 5000); ++i) around.touch();
  ASSERT_EQ(around.seen.size(), 2U);
  EXPECT_LT(around.seen[1].shown_n_per_m, around.seen[0].shown_n_per_m);
  EXPECT_GT(around.seen[1].damping_ns_per_m, 0.0);
  around.plan(300.0);
  for (int i = 0; i < 600 || (around.seen.size() < 3 && i < 5000); ++i) around.touch();
  ASSERT_EQ(around.seen.size(), 3U);
  EXPECT_LT(largest_step(around.forces), 0.05 * kForce) << "of a held contact; a jump would be felt as a knock";
  EXPECT_GT(around.forces.back(), 0.2 * kForce) << "the same contact is still felt";
  EXPECT_EQ(around.node.end(), 0);
}

TEST(CouplingNode, CommandsNothingWhereNoCouplingHolds) {
  Around around("{design: auto, hand: any_passive}");
  around.describe(0.005);
  around.plan();
  ASSERT_TRUE(wait_until([&] {
    around.look();
    return !around.seen.empty();
  }));
  EXPECT_EQ(around.seen[0].status, "infeasible");
  EXPECT_GT(around.seen[0].reasons, 0U);
  for (int i = 0; i < 200; ++i) around.touch();
  EXPECT_TRUE(around.forces.empty());
  EXPECT_TRUE(wait_until([&] { return around.message().find("run_infeasible") != std::string::npos; })) << around.message();
  EXPECT_EQ(around.node.end(), 0);
}

TEST(CouplingNode, RunsAnInfeasibleDesignWhereTheSceneSaysSo) {
  Around around("{design: auto, hand: any_passive, run_infeasible: true}");
  around.describe(0.005);
  around.plan();
  ASSERT_TRUE(wait_until([&] {
    around.look();
    return !around.seen.empty();
  }));
  EXPECT_EQ(around.seen[0].status, "infeasible");
  for (int i = 0; i < 200; ++i) around.touch();
  EXPECT_FALSE(around.forces.empty());
  EXPECT_EQ(around.node.end(), 0);
}

TEST(CouplingNode, StopsCommandingWhenAChangedDeviceLeavesNothingThatHolds) {
  Around around("{design: auto, hand: any_passive}");
  around.describe(20.0);
  around.plan();
  ASSERT_TRUE(wait_until([&] {
    around.look();
    return !around.seen.empty();
  }));
  for (int i = 0; i < 100; ++i) around.touch();
  ASSERT_FALSE(around.forces.empty());
  around.describe(0.005);
  ASSERT_TRUE(wait_until([&] {
    around.touch();
    return around.seen.size() == 2;
  }));
  EXPECT_EQ(around.seen[1].status, "infeasible");
  for (int i = 0; i < 20; ++i) around.touch();
  around.forces.clear();
  for (int i = 0; i < 100; ++i) around.touch();
  EXPECT_TRUE(around.forces.empty());
  EXPECT_EQ(around.node.end(), 0);
}

/// The second line: whatever the rendering has taken, it is held against the device once more where the force is made.
TEST(CouplingNode, CommandsNothingWhileTheEffectsAskMoreThanTheDeviceStands) {
  Around around("{design: auto, kind: shaping_filter}");
  around.describe(20.0);
  around.plan();
  ASSERT_TRUE(around.force_comes());
  around.plan(30.0, 7, {50.0, 0.0, ""});
  around.expect_no_force("the effects damp with up to 50 Ns/m at the hand, 'oil' most of it");
  around.plan(30.0, 7, {0.1, 0.0, ""});
  EXPECT_TRUE(around.force_comes());
  around.plan(30.0, 7, {0.0, 0.0, "oil"});
  around.expect_no_force("'oil' gives torque");
  around.plan();
  EXPECT_TRUE(around.force_comes());
  EXPECT_EQ(around.node.end(), 0);
}

TEST(CouplingNode, CommandsNothingWhileTheEffectsDampTurningMoreThanTheDeviceStands) {
  Around around("{design: auto, kind: shaping_filter}");
  around.describe_one_that_gives_torque();
  around.plan(30.0, 7, {0.0, 0.0, "oil", 0.01});
  ASSERT_TRUE(around.force_comes()) << around.message();
  around.plan(30.0, 7, {0.0, 0.0, "oil", 5.0});
  around.expect_no_force("the effects damp turning with up to 5 Nms/rad at the hand, 'oil' most of it");
  around.plan(30.0, 7, {0.0, 0.0, "oil", 0.01});
  EXPECT_TRUE(around.force_comes()) << around.message();
  EXPECT_EQ(around.node.end(), 0);
}

TEST(CouplingNode, CommandsNothingWhileAnOutsideWrenchMayAskForMoreThanTheDeviceGives) {
  Around around("{design: auto, kind: shaping_filter}");
  around.describe(20.0);
  around.plan(30.0, 7, {0.0, 0.0, "", 0.0, 2.0});
  ASSERT_TRUE(around.force_comes()) << around.message();
  EXPECT_TRUE(std::ranges::any_of(around.notes, [](const std::string& note) { return note.find("No certificate covers the effect 'remote'") != std::string::npos; }))
      << "the design says so";
  around.plan(30.0, 7, {0.0, 0.0, "", 0.0, 9.0});
  around.expect_no_force("the effect 'remote' may ask for a force of 9 N at the hand, and the device gives");
  around.plan(30.0, 7, {0.0, 0.0, "", 0.0, std::numeric_limits<double>::quiet_NaN()});
  around.expect_no_force("'remote'");
  around.plan(30.0, 7, {0.0, 0.0, "", 0.0, 2.0});
  EXPECT_TRUE(around.force_comes()) << around.message();
  EXPECT_EQ(around.node.end(), 0);
}

/// Another rendering may run another scene: nothing of it is felt before its plan has come and has been fitted to.
TEST(CouplingNode, CommandsNothingForARenderingThatTakesTheRoleBeforeItsPlanIsFittedTo) {
  Around around("{design: auto, kind: shaping_filter}");
  around.describe(20.0);
  around.plan();
  ASSERT_TRUE(around.force_comes());
  around.forces.clear();
  for (int i = 0; i < 100; ++i) around.touch(8);
  EXPECT_TRUE(around.forces.empty()) << "contacts of another session";
  auto second = std::make_unique<StandIn>(kDomain, "rendering", around.rig);
  bus::Writer<msg::ScenePlan> plans(second->participant, qos::kScenePlan, around.rig, Around::latched());
  bus::Writer<msg::ContactState> contacts(second->participant, qos::kContactState, around.rig, Around::stream());
  ASSERT_TRUE(wait_until([&] { return plans.matched_count() > 0 && contacts.matched_count() > 0; }));
  second->say(7);
  around.contacts = {}, around.plans = {}, around.rendering.reset();
  around.contacts = std::move(contacts), around.plans = std::move(plans), around.rendering = std::move(second);
  for (int i = 0; i < 50; ++i) around.touch();
  around.forces.clear();
  for (int i = 0; i < 500; ++i) around.touch();
  EXPECT_TRUE(around.forces.empty()) << "by the plan of the one before";
  const std::size_t designs = around.seen.size();
  around.plan();
  EXPECT_TRUE(around.force_comes()) << around.message();
  EXPECT_EQ(around.seen.size(), designs + 1) << "by the coupling of the one before";
  EXPECT_EQ(around.node.end(), 0);
}

TEST(CouplingNode, CommandsNothingWhereTheDeviceHasBecomeOneThatDoesNotStandTheEffects) {
  Around around("{design: auto, kind: shaping_filter}");
  around.describe(20.0);
  around.plan(30.0, 7, {1.0, 0.0, ""});
  ASSERT_TRUE(around.force_comes());
  around.describe(20.0, 7, 0.001);
  around.expect_no_force("a device of 0.001 kg let go stands");
  around.describe(20.0);
  EXPECT_TRUE(around.force_comes());
  EXPECT_EQ(around.node.end(), 0);
}

TEST(CouplingNode, CommandsNothingWhereACouplingSetByHandMeetsEffectsTooStiffForTheDevice) {
  Around around("{kind: shaping_filter, cutoff_hz: 100, damping_ratio: 1, gain: 1}");
  around.describe(2.0);
  around.plan(30.0, 7, {0.0, 100.0, ""});
  ASSERT_TRUE(around.force_comes());
  around.plan(30.0, 7, {0.0, 900.0, ""});
  around.expect_no_force("900 N/m at the hand; the device can show 800 N/m. Lower oil");
  EXPECT_EQ(around.node.end(), 0);
}

TEST(CouplingNode, JudgesACouplingThatIsSetByHandAndRunsIt) {
  Around around("{kind: shaping_filter, cutoff_hz: 5, damping_ratio: 1, gain: 1}");  // the paper's recipe
  around.describe(0.005);
  around.plan(3.0);
  ASSERT_TRUE(wait_until([&] {
    around.look();
    return !around.seen.empty();
  }));
  EXPECT_EQ(around.seen[0].status, "configured");
  EXPECT_EQ(around.seen[0].cutoff_hz, 5.0);
  EXPECT_GT(around.seen[0].reasons, 0U) << "300 N/m through a 5 Hz filter are not stable on this device";
  for (int i = 0; i < 600; ++i) around.touch();
  ASSERT_FALSE(around.forces.empty());
  EXPECT_NEAR(around.forces.back(), kForce, 0.1 * kForce);
  EXPECT_EQ(around.node.end(), 0);
}

/// Such a number may be forged with the rendering's own GUID, which DDS without security cannot tell from the rightful one.
TEST(CouplingNode, FeelsTheContactsThatFollowOneWithANumberFarAhead) {
  Around a("{design: auto}");
  a.describe(20.0), a.plan();
  ASSERT_TRUE(a.force_comes()) << a.message();
  const std::uint64_t next = std::exchange(a.sequence, std::uint64_t{1} << 40);
  a.touch();
  a.sequence = next;
  EXPECT_TRUE(a.force_comes()) << a.message();
}

/// DDS makes a write anew that it could not end in time, and who had it already has it twice. Answered twice, the filter would be a step ahead.
TEST(CouplingNode, AnswersAContactThatComesTwiceOnceInLockstep) {
  Around a("{design: auto}", true);
  a.describe(20.0), a.plan();
  ASSERT_TRUE(a.force_comes()) << a.message();
  std::this_thread::sleep_for(milliseconds(200));
  a.look(), a.forces.clear();
  for (int n = 0; n < 50; ++n) {
    a.touch();
    --a.sequence;
    a.touch();
  }
  std::this_thread::sleep_for(milliseconds(200));
  a.look();
  EXPECT_EQ(a.forces.size(), 50U);
}

/// A contact that pushes only on the way out gives energy at each stroke.
TEST(CouplingNode, LocksItselfAtZeroWhereAContactGivesEnergyAndWaitsForAPersonsWord) {
  Around a("{kind: shaping_filter, cutoff_hz: 20}");
  bus::Writer<msg::Recover> person(a.participant, qos::kRecover, a.rig, qos::profile(qos::ProfileId::kEvent));
  a.describe(20.0), a.plan();
  ASSERT_TRUE(a.force_comes()) << a.message();
  const auto lock = [&] {
    a.registry.update();
    const auto report = a.registry.find("coupling");
    const auto number = report ? report->values.find("lock") : std::map<std::string, std::string>::iterator{};
    return report && number != report->values.end() ? std::stoull(number->second) : 0;
  };
  for (int n = 0; n < 90; ++n) a.touch(-kDepth * (1.0 + 0.1 * n), 0.0);
  for (int stroke = 0; stroke < 20 && lock() == 0; ++stroke)
    for (int n = 0; n < 200; ++n) a.touch(-kDepth * (n < 100 ? 10 - 0.1 * n : 0.1 * (n - 100)), n < 100 ? 3.0 : 0.0);
  const std::uint64_t number = lock();
  ASSERT_NE(number, 0U) << a.message() << "; the lowest account was " << a.registry.find("coupling")->figures["lowest_energy_j"].value << " J of "
                        << a.registry.find("coupling")->figures["energy_bound_j"].value;
  EXPECT_NE(a.message().find("locked at zero force"), std::string::npos) << a.message();
  for (int n = 0; n < 20; ++n) a.touch();
  a.forces.clear();
  person.write(msg::Recover{7, number + 1});
  person.write(msg::Recover{8, number});
  for (int n = 0; n < 300; ++n) a.touch();
  ASSERT_GT(a.forces.size(), 200U) << "the ring goes on";
  EXPECT_EQ(*std::ranges::max_element(a.forces), 0.0) << "another lock's number, or another session's";
  person.write(msg::Recover{7, number});
  EXPECT_TRUE(a.force_comes()) << a.message();
  EXPECT_EQ(lock(), 0U);
}

/// One stroke that gives energy: six times what a sound contact shows and more, but little; and much, but less than five times that.
TEST(CouplingNode, LocksItselfForNothingThatIsLittleOrLessThanFiveTimesWhatIsSound) {
  struct Stroke {
    double force_n, voxel_m;
    bool is_little;
  };
  for (const Stroke& stroke : {Stroke{0.4, 0.0, true}, Stroke{3.0, 1.5e-3, false}}) {
    SCOPED_TRACE(stroke.force_n);
    Around a("{kind: shaping_filter, cutoff_hz: 20}");
    const Around::Demand demand{0.0, 0.0, ""};
    msg::ScenePlan plan = Around::message_of(30.0, 7, demand);
    plan.voxel_size_m = stroke.voxel_m;
    a.describe(20.0), a.plans.write(plan), a.rendering->say(7);
    ASSERT_TRUE(a.force_comes()) << a.message();
    for (int n = 0; n < 90; ++n) a.touch(-kDepth * (1.0 + 0.1 * n), 0.0);
    for (int n = 0; n < 100; ++n) a.touch(-kDepth * (10 - 0.1 * n), stroke.force_n);
    const auto figures = [&] {
      a.registry.update();
      const auto report = a.registry.find("coupling");
      return report ? report->figures : runtime::Figures();
    };
    ASSERT_TRUE(wait_until([&] { return figures()["samples"].value >= static_cast<double>(a.sequence) - 20.0; }));
    const double debt_j = -figures()["lowest_energy_j"].value, bound_j = figures()["energy_bound_j"].value;
    EXPECT_EQ(debt_j < 0.01, stroke.is_little) << debt_j;
    EXPECT_EQ(debt_j > 5.0 * bound_j, stroke.is_little) << debt_j << " J of " << bound_j;
    EXPECT_GT(debt_j, bound_j);
    EXPECT_EQ(figures()["locks"].value, 0.0) << a.message();
  }
}

/// Another coupling acts, and falls silent: this one goes on with the force at hand, or with its lock.
TEST(CouplingNode, StandsByWithTheForceAndTheLockOfTheOneThatActs) {
  for (const bool locked : {false, true}) {
    SCOPED_TRACE(locked);
    Around a("{kind: shaping_filter, cutoff_hz: 20}", false, true);
    StandIn acting(kDomain, "coupling", a.rig);
    bus::Writer<msg::ForceCommand> commands(acting.participant, qos::kForceCommand, a.rig, Around::stream());
    a.describe(20.0), a.plan();
    std::uint32_t status = 0;
    const auto standby = [&] {
      a.registry.update();
      return a.registry.find("coupling_standby");
    };
    const auto answer = [&] {
      runtime::NodeReport report;
      report.session_id = 7, report.state = runtime::NodeState::kRunning;
      if (const auto other = standby()) report.values[runtime::kStandby] = runtime::to_hex(other->participant);
      if (a.sequence % 50 == 0) acting.status.publish(report);
      msg::ForceCommand m{};
      m.session_id = 7, m.sequence_number = a.sequence, m.status = status;
      a.touch();
      commands.write(m);
    };
    ASSERT_TRUE(wait_until([&] {
      answer();
      const auto other = standby();
      return other && other->message.starts_with("stands by for coupling");
    })) << (standby() ? standby()->message : "");
    for (int n = 0; n < 600; ++n) answer();
    EXPECT_EQ(*std::ranges::max_element(a.forces), 0.0) << "it sends nothing";
    EXPECT_TRUE(a.seen.empty()) << "nor does it say what it has designed";
    status = locked ? msg::force_command::kStatusLocked : 0U;
    for (int n = 0; n < 50; ++n) answer();
    a.forces.clear();
    for (int n = 0; n < 30; ++n) a.touch();
    ASSERT_GT(a.forces.size(), 10U) << "it takes over";
    if (locked) {
      EXPECT_EQ(*std::ranges::max_element(a.forces), 0.0) << "a takeover opens no lock";
    } else {
      const auto first = std::ranges::find_if(a.forces, [](double force_n) { return force_n > 0.0; });  // behind the last of the other one
      ASSERT_NE(first, a.forces.end());
      EXPECT_GT(*first, 0.9 * kForce) << "and without a ramp";
    }
    EXPECT_TRUE(wait_until([&] { return a.touch(), a.seen.size() == 1; }));
  }
}

TEST(CouplingNode, RefusesNumbersThatCannotBeADevicesAndGoesOnAsDesigned) {
  Around around("{design: auto, kind: shaping_filter}");
  around.describe(20.0);
  around.plan();
  ASSERT_TRUE(wait_until([&] {
    around.look();
    return around.seen.size() == 1;
  }));
  for (int i = 0; i < 300; ++i) around.touch();
  for (const double impossible : {std::nan(""), -1.0, 1e9}) {
    around.describe(impossible);
    ASSERT_TRUE(wait_until([&] {
      around.touch();
      return around.message().find("damping_ns_per_m") != std::string::npos;
    })) << around.message();
    const std::size_t designs = around.seen.size();
    around.forces.clear();
    for (int i = 0; i < 200; ++i) around.touch();
    EXPECT_EQ(around.seen.size(), designs) << "it designs for a device that cannot be";
    EXPECT_FALSE(around.forces.empty());
    around.describe(20.0);
    ASSERT_TRUE(wait_until([&] {  // and the design for it, which takes its time, is made before the next refusal
      around.touch();
      return around.message().find("damping_ns_per_m") == std::string::npos && around.seen.size() > designs;
    })) << around.message();
  }
  around.forces.clear();
  for (int i = 0; i < 300; ++i) around.touch();
  ASSERT_FALSE(around.forces.empty());
  EXPECT_NEAR(around.forces.back(), kForce, 0.1 * kForce);
  EXPECT_EQ(around.node.end(), 0);
}

/// A fit takes some tenths of a second; what comes meanwhile is not in it.
TEST(Fitting, IsJudgedOnceMoreForWhatHasComeMeanwhile) {
  const scene::Scene scene = scene::load_scene(scene_with("{design: auto, kind: shaping_filter}"));
  const Around::Demand little{0.1, 0.0, ""}, much{50.0, 0.0, ""};
  coupling_node::Fitting fitting(scene);
  fitting.set_device(runtime::from_msg(stylus(7)), 7);
  fitting.set_plan(Around::message_of(30.0, 7, little));
  ASSERT_EQ(fitting.fit().refusal, "");
  fitting.begin();
  fitting.set_plan(Around::message_of(30.0, 7, much));
  std::optional<fitting::FittedCoupling> fitted;
  ASSERT_TRUE(wait_until([&] { return (fitted = fitting.poll()).has_value(); }));
  EXPECT_NE(fitted->refusal.find("'oil'"), std::string::npos) << fitted->refusal;
}

}  // namespace
}  // namespace voxtouch::test
