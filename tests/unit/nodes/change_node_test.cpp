// Changes of a running rendering node, over real DDS: results and refusals.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "core/scene/scene_file.hpp"
#include "nodes/rendering/rendering_node.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "tests/support/stand_in.hpp"
#include "tests/unit/nodes/asker.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds;
using namespace msg::effect_change;
namespace result = msg::effect_changed;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kPressed = 0.0085, kSpeed = 0.1;

/// plane.yaml with a thick liquid, as a file that a test may change.
class SceneCopy {
 public:
  SceneCopy()
      : file(std::filesystem::temp_directory_path() /
             ("change_node_test_" + std::to_string(getpid()) + ".yaml")) {
    std::ifstream in(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
    std::stringstream text;
    text << in.rdbuf();
    text_ = text.str();
    replace("../meshes", std::string(VOXTOUCH_DEPLOY) + "/meshes");
    replace("effects: []", "effects: [{viscosity: {damping_ns_per_m: 2}}]");
  }
  ~SceneCopy() { std::filesystem::remove(file); }
  void replace(const std::string& from, const std::string& to) {
    ASSERT_NE(text_.find(from), std::string::npos) << from;
    for (std::size_t at = 0; (at = text_.find(from, at)) != std::string::npos; at += to.size())
      text_.replace(at, from.size(), to);
    std::ofstream(file) << text_;
  }
  std::filesystem::path file;

 private:
  std::string text_;
};

class RenderingLive : public testing::Test {
 protected:
  RenderingLive()
      : rig(own_rig("x")),
        device(kDomain, "device", rig),
        participant(device.participant),
        registry(participant, rig),
        descriptions(participant, qos::kDeviceDescription, rig, latched()),
        plans(participant, qos::kScenePlan, rig, latched()),
        states(participant, qos::kDeviceState, rig, qos::profile(qos::ProfileId::kStream)),
        contacts(participant, qos::kContactState, rig, qos::profile(qos::ProfileId::kTap)),
        asker(participant, rig),
        options(node_options<rendering_node::Options>(rig)),
        node([this](const std::atomic<bool>& stop) {
          options.scene = scene.file;
          return rendering_node::run(options, stop);
        }) {
    EXPECT_TRUE(asker.ready());
    EXPECT_TRUE(asker.send_until_received(change(99), 1'000'000));
  }
  void describe(std::uint64_t id, double mass_kg = 0.1) {
    msg::DeviceDescription m = stylus(session = id);
    m.mass_min_kg = mass_kg, m.mass_max_kg = 2.0 * mass_kg;
    descriptions.write(m);
    device.say(id);
  }
  void begin(std::uint64_t id) {
    describe(id);
    sequence = 0;
    ASSERT_TRUE(wait_until([&] {
      poll();
      return planned == id && states.matched_count() == 1 && contacts.matched_count() == 1;
    }));
  }
  void poll() {
    plans.take_each([this](const msg::ScenePlan& p) {
      planned = p.session_id, demanded_ns_per_m = p.effects_damping_ns_per_m,
      plan_from_sample = p.from_sample, voxel_size_m = p.voxel_size_m, model = p.contact_model,
      ++plan_count;
    });
    msg::ContactState c;
    while (contacts.take(c)) {
      if (!seen.empty()) {
        // Samples may be lost in real time: the time between two received ones counts.
        const auto ms = static_cast<double>(c.sequence_number - seen.back().sequence_number);
        const auto &a = seen.back().wrench.force, &b = c.wrench.force;
        if (ms > 0)
          largest_step = std::max(largest_step, std::hypot(b.x - a.x, b.y - a.y, b.z - a.z) / ms);
      }
      seen.push_back(c);
    }
  }
  /// One sample of a tool that slides, pressed into the plane, and the answer.
  void sample() {
    msg::DeviceState m{};
    m.session_id = session;
    m.sequence_number = sequence++;
    m.sample_time_ns = static_cast<std::int64_t>(m.sequence_number) * 1'000'000;
    m.pose.position = {0.003, 0.002, kPressed};
    m.pose.orientation.w = 1.0;
    m.twist.linear.x = kSpeed;
    states.write(m);
    std::this_thread::sleep_for(milliseconds(1));
    poll();
  }
  void samples(int count) {
    for (int i = 0; i < 5000 && seen.empty(); ++i)
      sample();  // no answer before scene and device are checked
    for (int i = 0; i < count; ++i)
      sample();
  }
  Said ask(const msg::EffectChange& m, const std::string& effect = "viscosity",
           const std::string& parameter = "", const std::string& contact_model = "") {
    return asker.last_word(asker.send(m, effect, parameter, contact_model), [this] { sample(); });
  }
  runtime::NodeReport report() {
    registry.update();
    return registry.find("rendering").value_or(runtime::NodeReport{});
  }
  /// Sends samples until the node's message has this text.
  bool says(const std::string& text) {
    return wait_until([&] {
      sample();
      return report().message.find(text) != std::string::npos;
    });
  }
  void refused(const Said& said, const std::string& why) {
    EXPECT_EQ(said.result, result::kResultRefused) << said.sentence;
    EXPECT_NE(said.sentence.find(why), std::string::npos)
        << said.sentence << "\n should say: " << why;
  }
  double drag() const { return seen.back().effects_wrench.force.x; }
  double push() const { return seen.back().wrench.force.z; }

  SceneCopy scene;
  std::string rig;
  StandIn device;
  const bus::Participant& participant;
  runtime::NodeRegistry registry;
  bus::Writer<msg::DeviceDescription> descriptions;
  bus::Reader<msg::ScenePlan> plans;
  bus::Writer<msg::DeviceState> states;
  bus::Reader<msg::ContactState> contacts;
  Asker asker;
  rendering_node::Options options;
  NodeThread node;
  std::uint64_t session = 0, sequence = 0, planned = 0, plan_from_sample = 0;
  int plan_count = 0;
  double voxel_size_m = 0.0, largest_step = 0.0, demanded_ns_per_m = 0.0;
  std::string model;
  std::vector<msg::ContactState> seen;
};

TEST_F(RenderingLive, SwitchesAndSetsAnEffectWithoutAStep) {
  begin(5);
  samples(50);
  ASSERT_NEAR(drag(), -2.0 * kSpeed, 1e-12);
  const double whole = 2.0 * kSpeed,
               ramp = 1.001 * whole * 0.001 / effects::EffectChain::kEffectRampS;
  largest_step = 0.0;
  const Said off = ask(change(kActionSwitch, 0.0));
  EXPECT_EQ(off.result, result::kResultDone) << off.sentence;
  EXPECT_EQ(off.session, 5U);
  EXPECT_GT(off.from_sample, 0U);
  EXPECT_NE(off.sentence.find("'viscosity'"), std::string::npos) << off.sentence;
  samples(150);
  EXPECT_EQ(drag(), 0.0);
  EXPECT_LE(largest_step, ramp);
  EXPECT_EQ(ask(change(kActionSwitch, 1.0)).result, result::kResultDone);
  EXPECT_EQ(ask(change(kActionGain, 0.5)).result, result::kResultDone);
  samples(150);
  EXPECT_NEAR(drag(), -kSpeed, 1e-12);
  EXPECT_EQ(ask(change(kActionValue, 1.0), "viscosity", "damping_ns_per_m").result,
            result::kResultDone);
  samples(150);
  EXPECT_NEAR(drag(), -0.5 * kSpeed, 1e-12);
  EXPECT_LE(largest_step, 2 * ramp) << "at most two ramps at once";
  samples(150);
  EXPECT_EQ(plan_count, 2) << "gain and switch demand nothing else of the device; the smaller "
                              "value does, once it has come";
  EXPECT_EQ(demanded_ns_per_m, 1.0);
}

TEST_F(RenderingLive, RefusesGarbageWithAMessageAndContinues) {
  begin(5);
  samples(50);
  const auto refused = [&](const msg::EffectChange& m, const std::string& effect,
                           const std::string& parameter, const std::string& contact_model,
                           const std::string& why) {
    const Said said = ask(m, effect, parameter, contact_model);
    EXPECT_EQ(said.result, result::kResultRefused) << said.sentence;
    EXPECT_NE(said.sentence.find(why), std::string::npos)
        << said.sentence << "\n should say: " << why;
    EXPECT_LT(said.sentence.size(), 500U);
  };
  const std::string v = "viscosity", endless(1'000'000, 'x');
  refused(change(kActionGain, kNan), v, "", "", "0 to 1");
  refused(change(kActionSwitch, kNan), v, "", "", "1 (on)");
  refused(change(kActionValue, kNan), v, "damping_ns_per_m", "", "not finite");
  refused(change(kActionValue, 1e9), v, "damping_ns_per_m", "", "0 to 100");
  refused(change(kActionValue, 1.0), v, "dampening", "", ": damping_ns_per_m");
  refused(change(kActionValue, 0.1), v, "damping_nms_per_rad", "", "not built");
  refused(change(kActionSwitch, 1.0), "honey", "", "", ": viscosity");
  refused(change(kActionSwitch, 1.0), "\x1b[2J\xff\xfe\n", "", "", "'?[2J");
  refused(change(kActionSwitch, 1.0), endless, "", "", "limit 64");
  refused(change(kActionValue, 1.0), v, endless, "", "limit 64");
  refused(change(kActionReload), "", "", endless, "limit 64");
  refused(change(0), v, "", "", "unknown action 0");
  refused(change(4'000'000'000U), v, "", "", "unknown action");
  refused(change(kActionSwitch, 0.0, 0, 6), v, "", "", "session 6");
  refused(change(kActionSwitch, 0.0, 1), v, "", "", "sample 1 has passed");
  refused(change(kActionSwitch, 0.0, ~std::uint64_t{0}), v, "", "", "10 s");
  refused(change(kActionReload), "", "", "best", "'best'");
  for (const double bad : {kNan, -0.001, std::numeric_limits<double>::infinity()}) {
    msg::EffectChange reload = change(kActionReload);
    reload.voxel_size_m = bad;
    refused(reload, "", "", "", "> 0");
  }
  for (int i = 0; i < 2000; ++i)
    asker.send(change(kActionValue, kNan), v, "damping_ns_per_m");
  samples(100);
  EXPECT_NEAR(drag(), -2.0 * kSpeed, 1e-12);
  EXPECT_LT(largest_step, 1e-9) << "nothing of it was displayed";
}

TEST_F(RenderingLive, WaitsForTheNamedSample) {
  begin(5);
  samples(20);
  const std::uint64_t at = sequence + 100;
  const std::uint64_t request = asker.send(change(kActionSwitch, 0.0, at), "viscosity");
  const Said said = asker.last_word(request, [this] { sample(); });
  EXPECT_EQ(said.result, result::kResultDone) << said.sentence;
  EXPECT_EQ(said.from_sample, at);
  ASSERT_EQ(asker.said[request].size(), 2U);
  EXPECT_EQ(asker.said[request][0].result, result::kResultPending);
  samples(20);
  for (const msg::ContactState& c : seen)
    if (c.sequence_number < at)
      EXPECT_NEAR(c.effects_wrench.force.x, -2.0 * kSpeed, 1e-12) << c.sequence_number;
    else
      EXPECT_GT(c.effects_wrench.force.x, -1.995 * kSpeed) << c.sequence_number;
}

TEST_F(RenderingLive, AnswersARepeatedRequestButActsOnce) {
  begin(5);
  samples(20);
  const std::uint64_t request = asker.send(change(kActionGain, 0.5), "viscosity");
  const Said first = asker.last_word(request, [this] { sample(); });
  EXPECT_EQ(ask(change(kActionGain, 1.0)).result, result::kResultDone);
  samples(150);
  asker.said.clear();
  msg::EffectChange again = change(kActionGain, 0.5);
  ASSERT_TRUE(asker.send_until_received(again, request));
  EXPECT_EQ(asker.said[request].back().from_sample, first.from_sample);
  samples(150);
  EXPECT_NEAR(drag(), -2.0 * kSpeed, 1e-12) << "the gain of the later change stays";
}

TEST_F(RenderingLive, NewSessionDropsPendingChanges) {
  begin(5);
  samples(20);
  const std::uint64_t request = asker.send(change(kActionSwitch, 0.0, sequence + 500), "viscosity");
  samples(50);
  begin(6);
  samples(700);
  const Said said = asker.last_word(request, [this] { sample(); });
  EXPECT_EQ(said.result, result::kResultRefused);
  EXPECT_NE(said.sentence.find("new session"), std::string::npos) << said.sentence;
  EXPECT_NEAR(drag(), -2.0 * kSpeed, 1e-12);
  EXPECT_EQ(ask(change(kActionSwitch, 0.0)).result, result::kResultDone)
      << "and nothing stays stuck";
}

TEST_F(RenderingLive, RebuildsTheSceneOutsideTheLoopAndFades) {
  begin(5);
  EXPECT_EQ(ask(change(kActionValue, 1.0), "viscosity", "damping_ns_per_m").result,
            result::kResultDone);
  samples(150);
  const double before = push();
  ASSERT_GT(before, 0.01);
  largest_step = 0.0;
  scene.replace("stiffness_n_per_m: 30}", "stiffness_n_per_m: 60}");
  msg::EffectChange reload = change(kActionReload);
  reload.voxel_size_m = 0.001;
  const Said said = ask(reload, "");
  EXPECT_EQ(said.result, result::kResultDone) << said.sentence;
  const std::size_t faded_from = seen.size();
  samples(260);
  EXPECT_EQ(voxel_size_m, 0.001);
  EXPECT_EQ(plan_from_sample, said.from_sample);
  EXPECT_EQ(plan_count, 3) << "the session's, the lower damping's, and this one";
  const double after = push();
  EXPECT_GT(std::abs(after - before), 0.5 * before);
  // The contact's stiffness fades evenly; the force behind the spring does not quite.
  EXPECT_LE(largest_step, 1.1 * std::abs(after - before) * 0.001 / rendering::LiveScene::kFadeS);
  EXPECT_NEAR(drag(), -1.0 * kSpeed, 1e-12)
      << "what was changed stays where the file says the same";
  int fading = 0;
  for (const msg::ContactState& c : seen)
    fading += (c.flags & msg::contact_state::kFlagFading) != 0;
  EXPECT_GT(fading, 100);
  EXPECT_LE(fading, 201);
  EXPECT_GT(seen.size(), faded_from);
  EXPECT_EQ(seen.back().flags & msg::contact_state::kFlagFading, 0U);
  EXPECT_EQ(ask(change(kActionReload), "", "", "original").result, result::kResultDone);
  samples(260);
  EXPECT_EQ(model, "original");
  const Said again = ask(change(kActionReload), "");
  EXPECT_EQ(again.result, result::kResultDone) << again.sentence;
  samples(260);
  EXPECT_EQ(voxel_size_m, 0.002) << "as the file says";
}

TEST_F(RenderingLive, KeepsTheOldSceneIfTheNewOneFails) {
  begin(5);
  samples(100);
  const double before = push();
  largest_step = 0.0;
  scene.replace("voxel_size: 0.002", "voxel_size: fine");
  Said said = ask(change(kActionReload), "");
  EXPECT_EQ(said.result, result::kResultRefused);
  EXPECT_NE(said.sentence.find(".yaml:4:13"), std::string::npos) << said.sentence;
  scene.replace("voxel_size: fine", "voxel_size: 0.002");
  scene.replace("force_scale: 1}", "force_scale: 2}");
  said = ask(change(kActionReload), "");
  EXPECT_EQ(said.result, result::kResultRefused);
  EXPECT_NE(said.sentence.find("'device'"), std::string::npos) << said.sentence;
  scene.replace("force_scale: 2}", "force_scale: 1}");
  msg::EffectChange reload = change(kActionReload);
  reload.voxel_size_m = 1e-7;
  said = ask(reload, "");
  EXPECT_EQ(said.result, result::kResultRefused) << "more memory than there is";
  samples(50);
  EXPECT_EQ(push(), before);
  EXPECT_EQ(largest_step, 0.0);
  EXPECT_EQ(plan_count, 1);
}

constexpr char kStands[] = "margin 2";

TEST_F(RenderingLive, RefusesChangesTheDeviceCannotBear) {
  begin(5);
  samples(50);
  const double before = drag();
  const std::string v = "viscosity", b = "damping_ns_per_m";
  refused(ask(change(kActionValue, 50.0), v, b), kStands);
  EXPECT_EQ(ask(change(kActionSwitch, 0.0)).result, result::kResultDone);
  refused(ask(change(kActionValue, 50.0), v, b), kStands);
  EXPECT_EQ(ask(change(kActionGain, 0.05)).result, result::kResultDone);
  refused(ask(change(kActionValue, 50.0), v, b), kStands);
  EXPECT_EQ(ask(change(kActionGain, 1.0)).result, result::kResultDone);
  EXPECT_EQ(ask(change(kActionSwitch, 1.0)).result, result::kResultDone);
  scene.replace("damping_ns_per_m: 2}", "damping_ns_per_m: 60}");
  refused(ask(change(kActionReload), ""), "current scene");
  refused(ask(change(kActionReload), ""), kStands);
  scene.replace("damping_ns_per_m: 60}", "damping_ns_per_m: 1, damping_nms_per_rad: 0.01}");
  refused(ask(change(kActionReload), ""), "torque");
  samples(150);
  EXPECT_NEAR(drag(), before, 1e-12);
  EXPECT_EQ(plan_count, 1);
}

TEST_F(RenderingLive, ChecksEarlierChangesWhenADeviceComes) {
  EXPECT_EQ(ask(change(kActionValue, 50.0), "viscosity", "damping_ns_per_m").result,
            result::kResultDone);
  const std::uint64_t waits =
      asker.send(change(kActionValue, 60.0, 300), "viscosity", "damping_ns_per_m");
  begin(5);
  EXPECT_EQ(demanded_ns_per_m, 50.0) << "the coupling is reported";
  EXPECT_TRUE(says("margin 2"));
  EXPECT_EQ(report().state, runtime::NodeState::kFailed);
  refused(asker.last_word(waits, [this] { sample(); }), kStands);
  EXPECT_EQ(ask(change(kActionValue, 1.0), "viscosity", "damping_ns_per_m").result,
            result::kResultDone);
  EXPECT_TRUE(says("is built"));
  EXPECT_EQ(demanded_ns_per_m, 1.0);
}

TEST_F(RenderingLive, DropsPendingChangesTheDeviceCannotBear) {
  const std::uint64_t waits =
      asker.send(change(kActionValue, 60.0, 300), "viscosity", "damping_ns_per_m");
  EXPECT_EQ(asker.first_word(waits).result, result::kResultPending);
  begin(5);
  samples(400);
  refused(asker.last_word(waits, [this] { sample(); }), kStands);
  samples(150);
  EXPECT_NEAR(drag(), -2.0 * kSpeed, 1e-12);
}

TEST_F(RenderingLive, ChecksEffectsAgainForANewDescription) {
  begin(5);
  samples(50);
  EXPECT_TRUE(says("is built"));
  describe(5, 0.005);
  EXPECT_TRUE(says("margin 2"));
  describe(5, 0.1);
  EXPECT_TRUE(says("is built"));
  EXPECT_EQ(ask(change(kActionValue, 3.0), "viscosity", "damping_ns_per_m").result,
            result::kResultDone);
}

TEST_F(RenderingLive, ChecksAgainForASessionOfAnotherDevice) {
  begin(5);
  samples(50);
  describe(6, 0.005);
  EXPECT_TRUE(says("margin 2"));
  refused(ask(change(kActionValue, 3.0), "viscosity", "damping_ns_per_m"), kStands);
}

/// A fading effect counts until it is zero, a decreasing one until it has reached its value.
TEST_F(RenderingLive, ReportsTheLargestDemandDuringATransition) {
  begin(5);
  samples(20);
  EXPECT_EQ(demanded_ns_per_m, 2.0);
  scene.replace("damping_ns_per_m: 2}", "damping_ns_per_m: 1}");
  EXPECT_EQ(ask(change(kActionReload), "").result, result::kResultDone);
  EXPECT_EQ(plan_count, 2);
  EXPECT_EQ(demanded_ns_per_m, 2.0) << "the old scene is still displayed";
  samples(260);
  EXPECT_EQ(demanded_ns_per_m, 1.0);
  EXPECT_EQ(ask(change(kActionValue, 0.5), "viscosity", "damping_ns_per_m").result,
            result::kResultDone);
  EXPECT_EQ(demanded_ns_per_m, 1.0) << "it is on its way";
  samples(150);
  EXPECT_EQ(demanded_ns_per_m, 0.5);
}

TEST_F(RenderingLive, ReportsPendingChangesAtOnceWithTheirDelay) {
  begin(5);
  samples(20);
  refused(ask(change(kActionSwitch, 0.0, sequence + 20'000)), "limit 10000 samples (10 s)");
  const std::uint64_t far = asker.send(change(kActionGain, 0.5, sequence + 1'000), "viscosity");
  const std::uint64_t behind = asker.send(change(kActionSwitch, 0.0), "viscosity");
  const Said done = asker.last_word(behind, [this] { sample(); });
  EXPECT_EQ(done.result, result::kResultDone) << done.sentence;
  EXPECT_EQ(done.from_sample, asker.said[far].back().from_sample) << "in order";
  const Said waits = asker.said[behind].front();
  EXPECT_EQ(waits.result, result::kResultPending);
}

TEST_F(RenderingLive, ContinuesAfterAnInvalidDescription) {
  begin(5);
  samples(20);
  msg::DeviceDescription none = stylus(5);
  none.mass_min_kg = std::numeric_limits<double>::quiet_NaN();
  descriptions.write(none);
  EXPECT_TRUE(says("device description")) << report().message;
  samples(50);
  EXPECT_NEAR(drag(), -2.0 * kSpeed, 1e-12) << "force goes on";
  descriptions.write(stylus(9));  // its status has 5
  samples(100);
  EXPECT_EQ(planned, 5U) << "a session is what status and description name";
  session = 9;
  samples(50);
  for (const msg::ContactState& c : seen)
    ASSERT_EQ(c.session_id, 5U) << "no sample of another session is answered";
}

TEST_F(RenderingLive, RefusesASampleBeforeThatOfAnEarlierChange) {
  begin(5);
  samples(20);
  const std::uint64_t far = asker.send(change(kActionGain, 0.5, sequence + 1'000), "viscosity");
  refused(ask(change(kActionSwitch, 0.0, sequence + 500)), "earlier");
  EXPECT_EQ(asker.last_word(far, [this] { sample(); }).result, result::kResultDone);
}

TEST_F(RenderingLive, TakesOneReloadAfterTheOther) {
  begin(5);
  samples(20);
  for (const char* contact_model : {"original", "adapted", "original", "adapted"}) {
    const Said said = ask(change(kActionReload), "", "", contact_model);
    EXPECT_EQ(said.result, result::kResultDone) << said.sentence;
  }
  samples(260);
  EXPECT_EQ(model, "adapted");
  EXPECT_EQ(seen.back().flags & msg::contact_state::kFlagFading, 0U);
}

TEST_F(RenderingLive, StopsWhileASceneIsBeingBuilt) {
  begin(5);
  msg::EffectChange reload = change(kActionReload);
  reload.voxel_size_m = 0.0002;
  asker.send(reload);
  samples(50);
  const auto before = std::chrono::steady_clock::now();
  EXPECT_EQ(node.end(), 0);
  EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::seconds(10));
}

}  // namespace
}  // namespace voxtouch::test
