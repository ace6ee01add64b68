// The rendering node asked to change while it runs, over real DDS: what it does, and what it refuses.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "core/scene/scene_file.hpp"
#include "nodes/rendering/scene_update_server.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/strings.hpp"
#include "tests/support/stand_in.hpp"
#include "tests/unit/nodes/node_thread.hpp"

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
      : file(std::filesystem::temp_directory_path() / ("change_node_test_" + std::to_string(getpid()) + ".yaml")) {
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

struct Said {
  std::uint32_t result = 0;
  std::uint64_t from_sample = 0, session = 0;
  std::string sentence;
};

/// Whoever asks: `voxtouch change`, or a ROS 2 tool.
class Asker {
 public:
  Asker(const bus::Participant& participant, const std::string& rig)
      : changes(participant, qos::kEffectChange, rig, qos::profile(qos::kEffectChange.profile)),
        answers(participant, qos::kEffectChanged, rig, qos::profile(qos::kEffectChanged.profile)) {}
  bool ready() {
    return wait_until([&] { return changes.matched_count() == 1 && answers.matched_count() == 1; });
  }

  /// Sends until somebody has heard: a first message may go before the other end knows this one.
  bool send_until_heard(msg::EffectChange m, std::uint64_t request) {
    static char none[] = "", name[] = "viscosity";
    m.request = request;
    m.effect = name, m.parameter = m.model = none;
    return wait_until([&] {
      changes.write(m);
      std::this_thread::sleep_for(milliseconds(20));
      answers.take_each([&](const msg::EffectChanged& a) {
        said[a.request].push_back({a.result, a.from_sample, a.session_id, a.sentence});
      });
      return !said[request].empty();
    });
  }
  std::uint64_t send(msg::EffectChange m, const std::string& effect = "", const std::string& parameter = "",
                     const std::string& model = "") {
    m.request = ++requests;
    m.effect = runtime::lend(effect), m.parameter = runtime::lend(parameter), m.model = runtime::lend(model);
    changes.write(m);
    return requests;
  }
  /// The last word on a request; `meanwhile` is done until it comes.
  Said last_word(std::uint64_t request, const std::function<void()>& meanwhile) {
    EXPECT_TRUE(wait_until([&] {
      meanwhile();
      answers.take_each([&](const msg::EffectChanged& a) {
        said[a.request].push_back({a.result, a.from_sample, a.session_id, a.sentence});
      });
      return !said[request].empty() && said[request].back().result != result::kResultWaiting;
    })) << "nobody answered "
        << request;
    return said[request].empty() ? Said{} : said[request].back();
  }

  bus::Writer<msg::EffectChange> changes;
  bus::Reader<msg::EffectChanged> answers;
  std::map<std::uint64_t, std::vector<Said>> said;
  std::uint64_t requests = 0;
};

msg::EffectChange change(std::uint32_t action, double value = 0.0, std::uint64_t from_sample = 0,
                         std::uint64_t session = 0) {
  msg::EffectChange m{};
  m.action = action;
  m.value[0] = value;
  m.from_sample = from_sample;
  m.session_id = session;
  return m;
}

const qos::Profile& latched() { return qos::profile(qos::ProfileId::kLatched); }

class RenderingLive : public testing::Test {
 protected:
  RenderingLive()
      : rig(own_rig("x")), device(kDomain, "device", rig), participant(device.participant), registry(participant, rig),
        descriptions(participant, qos::kDeviceDescription, rig, latched()),
        plans(participant, qos::kScenePlan, rig, latched()),
        states(participant, qos::kDeviceState, rig, qos::profile(qos::ProfileId::kStream)),
        contacts(participant, qos::kContactState, rig, qos::profile(qos::ProfileId::kTap)), asker(participant, rig),
        options(node_options<rendering_node::Options>(rig)), node([this](const std::atomic<bool>& stop) {
          options.scene = scene.file;
          return rendering_node::run(options, stop);
        }) {
    EXPECT_TRUE(asker.ready());
    EXPECT_TRUE(asker.send_until_heard(change(99), 1'000'000));
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
      look();
      return planned == id && states.matched_count() == 1 && contacts.matched_count() == 1;
    }));
  }
  void look() {
    plans.take_each([this](const msg::ScenePlan& p) {
      planned = p.session_id, demanded_ns_per_m = p.effects_damping_ns_per_m, plan_from_sample = p.from_sample, voxel_size_m = p.voxel_size_m, model = p.contact_model,
      ++plan_count;
    });
    msg::ContactState c;
    while (contacts.take(c)) {
      if (!seen.empty()) {
        // Samples may be lost in real time: the time between two that came counts.
        const auto ms = static_cast<double>(c.sequence_number - seen.back().sequence_number);
        const auto &a = seen.back().wrench.force, &b = c.wrench.force;
        if (ms > 0) largest_step = std::max(largest_step, std::hypot(b.x - a.x, b.y - a.y, b.z - a.z) / ms);
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
    look();
  }
  void samples(int count) {
    for (int i = 0; i < count; ++i) sample();
  }
  Said ask(const msg::EffectChange& m, const std::string& effect = "viscosity", const std::string& parameter = "",
           const std::string& contact_model = "") {
    return asker.last_word(asker.send(m, effect, parameter, contact_model), [this] { sample(); });
  }
  runtime::NodeReport report() {
    registry.update();
    return registry.find("rendering").value_or(runtime::NodeReport{});
  }
  /// Samples go on until the node says so of itself.
  bool says(const std::string& text) {
    return wait_until([&] {
      sample();
      return report().message.find(text) != std::string::npos;
    });
  }
  void refused(const Said& said, const std::string& why) {
    EXPECT_EQ(said.result, result::kResultRefused) << said.sentence;
    EXPECT_NE(said.sentence.find(why), std::string::npos) << said.sentence << "\n should say: " << why;
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
  const double whole = 2.0 * kSpeed, ramp = 1.001 * whole * 0.001 / effects::EffectChain::kEffectRampS;
  largest_step = 0.0;
  const Said off = ask(change(kActionSwitch, 0.0));
  EXPECT_EQ(off.result, result::kResultDone) << off.sentence;
  EXPECT_EQ(off.session, 5U);
  EXPECT_GT(off.from_sample, 0U);
  EXPECT_NE(off.sentence.find("'viscosity' off"), std::string::npos) << off.sentence;
  samples(150);
  EXPECT_EQ(drag(), 0.0);
  EXPECT_LE(largest_step, ramp);
  EXPECT_EQ(ask(change(kActionSwitch, 1.0)).result, result::kResultDone);
  EXPECT_EQ(ask(change(kActionGain, 0.5)).result, result::kResultDone);
  samples(150);
  EXPECT_NEAR(drag(), -kSpeed, 1e-12);
  EXPECT_EQ(ask(change(kActionValue, 1.0), "viscosity", "damping_ns_per_m").result, result::kResultDone);
  samples(150);
  EXPECT_NEAR(drag(), -0.5 * kSpeed, 1e-12);
  EXPECT_LE(largest_step, 2 * ramp) << "at most two ramps at once";
  samples(150);
  EXPECT_EQ(plan_count, 2) << "gain and switch demand nothing else of the device; the smaller value does, once it has come";
  EXPECT_EQ(demanded_ns_per_m, 1.0);
}

TEST_F(RenderingLive, RefusesGarbageWithASentenceAndGoesOnAsBefore) {
  begin(5);
  samples(50);
  const auto refused = [&](const msg::EffectChange& m, const std::string& effect, const std::string& parameter,
                           const std::string& contact_model, const std::string& why) {
    const Said said = ask(m, effect, parameter, contact_model);
    EXPECT_EQ(said.result, result::kResultRefused) << said.sentence;
    EXPECT_NE(said.sentence.find(why), std::string::npos) << said.sentence << "\n should say: " << why;
    EXPECT_LT(said.sentence.size(), 500U);
  };
  const std::string v = "viscosity", endless(1'000'000, 'x');
  refused(change(kActionGain, kNan), v, "", "", "0 to 1");
  refused(change(kActionSwitch, kNan), v, "", "", "1 (on)");
  refused(change(kActionValue, kNan), v, "damping_ns_per_m", "", "not finite");
  refused(change(kActionValue, 1e9), v, "damping_ns_per_m", "", "from 0 to 100");
  refused(change(kActionValue, 1.0), v, "dampening", "", "it takes: damping_ns_per_m");
  refused(change(kActionValue, 0.1), v, "damping_nms_per_rad", "", "not built");
  refused(change(kActionSwitch, 1.0), "honey", "", "", "the scene lists: viscosity");
  refused(change(kActionSwitch, 1.0), "\x1b[2J\xff\xfe\n", "", "", "'?[2J");
  refused(change(kActionSwitch, 1.0), endless, "", "", "longer than 64");
  refused(change(kActionValue, 1.0), v, endless, "", "longer than 64");
  refused(change(kActionReload), "", "", endless, "longer than 64");
  refused(change(0), v, "", "", "no action 0");
  refused(change(4'000'000'000U), v, "", "", "no action");
  refused(change(kActionSwitch, 0.0, 0, 6), v, "", "", "session 6 does not run (5 does)");
  refused(change(kActionSwitch, 0.0, 1), v, "", "", "sample 1 has passed");
  refused(change(kActionSwitch, 0.0, ~std::uint64_t{0}), v, "", "", "10 s: changes are made in order");
  refused(change(kActionReload), "", "", "best", "no contact model 'best'");
  for (const double bad : {kNan, -0.001, std::numeric_limits<double>::infinity()}) {
    msg::EffectChange reload = change(kActionReload);
    reload.voxel_size_m = bad;
    refused(reload, "", "", "", "above 0");
  }
  for (int i = 0; i < 2000; ++i) asker.send(change(kActionValue, kNan), v, "damping_ns_per_m");
  samples(100);
  EXPECT_NEAR(drag(), -2.0 * kSpeed, 1e-12);
  EXPECT_LT(largest_step, 1e-9) << "nothing of it was felt";
}

TEST_F(RenderingLive, WaitsForTheSampleThatWasNamed) {
  begin(5);
  samples(20);
  const std::uint64_t at = sequence + 100;
  const std::uint64_t request = asker.send(change(kActionSwitch, 0.0, at), "viscosity");
  const Said said = asker.last_word(request, [this] { sample(); });
  EXPECT_EQ(said.result, result::kResultDone) << said.sentence;
  EXPECT_EQ(said.from_sample, at);
  ASSERT_EQ(asker.said[request].size(), 2U);
  EXPECT_EQ(asker.said[request][0].result, result::kResultWaiting);
  samples(20);
  for (const msg::ContactState& c : seen)
    if (c.sequence_number < at)
      EXPECT_NEAR(c.effects_wrench.force.x, -2.0 * kSpeed, 1e-12) << c.sequence_number;
    else
      EXPECT_GT(c.effects_wrench.force.x, -1.995 * kSpeed) << c.sequence_number;
}

TEST_F(RenderingLive, AnswersWhatIsAskedAgainButDoesItOnce) {
  begin(5);
  samples(20);
  const std::uint64_t request = asker.send(change(kActionGain, 0.5), "viscosity");
  const Said first = asker.last_word(request, [this] { sample(); });
  EXPECT_EQ(ask(change(kActionGain, 1.0)).result, result::kResultDone);
  samples(150);
  asker.said.clear();
  msg::EffectChange again = change(kActionGain, 0.5);
  ASSERT_TRUE(asker.send_until_heard(again, request));
  EXPECT_EQ(asker.said[request].back().from_sample, first.from_sample);
  samples(150);
  EXPECT_NEAR(drag(), -2.0 * kSpeed, 1e-12) << "the gain of the later change stays";
}

TEST_F(RenderingLive, DropsWhatWaitsForASampleOfASessionThatHasEnded) {
  begin(5);
  samples(20);
  const std::uint64_t request = asker.send(change(kActionSwitch, 0.0, sequence + 500), "viscosity");
  samples(50);
  begin(6);
  samples(700);
  const Said said = asker.last_word(request, [this] { sample(); });
  EXPECT_EQ(said.result, result::kResultRefused);
  EXPECT_NE(said.sentence.find("another session"), std::string::npos) << said.sentence;
  EXPECT_NEAR(drag(), -2.0 * kSpeed, 1e-12);
  EXPECT_EQ(ask(change(kActionSwitch, 0.0)).result, result::kResultDone) << "and nothing stays stuck";
}

TEST_F(RenderingLive, BuildsTheSceneAnewBesideTheLoopAndFadesOverToIt) {
  begin(5);
  EXPECT_EQ(ask(change(kActionValue, 1.0), "viscosity", "damping_ns_per_m").result, result::kResultDone);
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
  EXPECT_LE(largest_step, 1.01 * std::abs(after - before) * 0.001 / rendering::LiveScene::kFadeS);
  EXPECT_NEAR(drag(), -1.0 * kSpeed, 1e-12) << "what was changed stays where the file says the same";
  int fading = 0;
  for (const msg::ContactState& c : seen) fading += (c.flags & msg::contact_state::kFlagFading) != 0;
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

TEST_F(RenderingLive, GoesOnWithTheOldSceneWhereTheNewOneCannotBeHad) {
  begin(5);
  samples(100);
  const double before = push();
  largest_step = 0.0;
  scene.replace("voxel_size: 0.002", "voxel_size: fine");
  Said said = ask(change(kActionReload), "");
  EXPECT_EQ(said.result, result::kResultRefused);
  EXPECT_NE(said.sentence.find("the old scene goes on"), std::string::npos) << said.sentence;
  EXPECT_NE(said.sentence.find(".yaml:4:13"), std::string::npos) << said.sentence;
  scene.replace("voxel_size: fine", "voxel_size: 0.002");
  scene.replace("force_scale: 1}", "force_scale: 2}");
  said = ask(change(kActionReload), "");
  EXPECT_NE(said.sentence.find("'device' section has changed"), std::string::npos) << said.sentence;
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

constexpr char kStands[] = "with a margin of 2: lower it below";

TEST_F(RenderingLive, RefusesEveryChangeThatTheDeviceDoesNotStand) {
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
  refused(ask(change(kActionReload), ""), "the old scene goes on");
  refused(ask(change(kActionReload), ""), kStands);
  scene.replace("damping_ns_per_m: 60}", "damping_ns_per_m: 1, damping_nms_per_rad: 0.01}");
  refused(ask(change(kActionReload), ""), "gives torque, and the device gives none");
  samples(150);
  EXPECT_NEAR(drag(), before, 1e-12);
  EXPECT_EQ(plan_count, 1);
  EXPECT_EQ(report().message.find("No force"), std::string::npos) << report().message;
}

TEST_F(RenderingLive, JudgesWhatWasChangedBeforeADeviceCameWhenItComes) {
  EXPECT_EQ(ask(change(kActionValue, 50.0), "viscosity", "damping_ns_per_m").result, result::kResultDone);
  const std::uint64_t waits = asker.send(change(kActionValue, 60.0, 300), "viscosity", "damping_ns_per_m");
  begin(5);
  EXPECT_EQ(demanded_ns_per_m, 50.0) << "the coupling is told";
  EXPECT_TRUE(says("with a margin of 2"));
  EXPECT_TRUE(says("No force is commanded"));
  EXPECT_EQ(report().state, runtime::NodeState::kFailed);
  refused(asker.last_word(waits, [this] { sample(); }), kStands);
  EXPECT_EQ(ask(change(kActionValue, 1.0), "viscosity", "damping_ns_per_m").result, result::kResultDone);
  EXPECT_TRUE(says("is built"));
  EXPECT_EQ(demanded_ns_per_m, 1.0);
}

TEST_F(RenderingLive, DropsWhatWaitsForASampleWhereTheDeviceThatComesDoesNotStandIt) {
  const std::uint64_t waits = asker.send(change(kActionValue, 60.0, 300), "viscosity", "damping_ns_per_m");
  ASSERT_TRUE(wait_until([&] {
    asker.answers.take_each([&](const msg::EffectChanged& a) { asker.said[a.request].push_back({a.result, a.from_sample, a.session_id, a.sentence}); });
    return !asker.said[waits].empty();
  }));
  begin(5);
  samples(400);
  refused(asker.last_word(waits, [this] { sample(); }), kStands);
  samples(150);
  EXPECT_NEAR(drag(), -2.0 * kSpeed, 1e-12);
}

TEST_F(RenderingLive, JudgesTheRunningEffectsAnewWhenTheDeviceDescribesItselfAnew) {
  begin(5);
  samples(50);
  EXPECT_TRUE(says("is built"));
  describe(5, 0.005);
  EXPECT_TRUE(says("with a margin of 2"));
  describe(5, 0.1);
  EXPECT_TRUE(says("is built"));
  EXPECT_EQ(ask(change(kActionValue, 3.0), "viscosity", "damping_ns_per_m").result, result::kResultDone);
}

TEST_F(RenderingLive, JudgesAnewWhenASessionOfAnotherDeviceBegins) {
  begin(5);
  samples(50);
  describe(6, 0.005);
  EXPECT_TRUE(says("with a margin of 2"));
  refused(ask(change(kActionValue, 3.0), "viscosity", "damping_ns_per_m"), kStands);
}

/// What fades out counts until it is gone, what goes down until it has come there.
TEST_F(RenderingLive, TellsTheCouplingTheMostThatIsRenderedUntilItIsOver) {
  begin(5);
  samples(20);
  EXPECT_EQ(demanded_ns_per_m, 2.0);
  scene.replace("damping_ns_per_m: 2}", "damping_ns_per_m: 1}");
  EXPECT_EQ(ask(change(kActionReload), "").result, result::kResultDone);
  EXPECT_EQ(plan_count, 2);
  EXPECT_EQ(demanded_ns_per_m, 2.0) << "the old scene is still felt";
  samples(260);
  EXPECT_EQ(demanded_ns_per_m, 1.0);
  EXPECT_EQ(ask(change(kActionValue, 0.5), "viscosity", "damping_ns_per_m").result, result::kResultDone);
  EXPECT_EQ(demanded_ns_per_m, 1.0) << "it is on its way";
  samples(150);
  EXPECT_EQ(demanded_ns_per_m, 0.5);
}

TEST_F(RenderingLive, SaysAtOnceWhatWaitsAndForHowLong) {
  begin(5);
  samples(20);
  refused(ask(change(kActionSwitch, 0.0, sequence + 20'000)), "more than 10000 samples away, 10 s");
  const std::uint64_t far = asker.send(change(kActionGain, 0.5, sequence + 1'000), "viscosity");
  const std::uint64_t behind = asker.send(change(kActionSwitch, 0.0), "viscosity");
  const Said done = asker.last_word(behind, [this] { sample(); });
  EXPECT_EQ(done.result, result::kResultDone) << done.sentence;
  EXPECT_EQ(done.from_sample, asker.said[far].back().from_sample) << "in order";
  const Said waits = asker.said[behind].front();
  EXPECT_EQ(waits.result, result::kResultWaiting);
  EXPECT_NE(waits.sentence.find("s of the device's time from now, behind a change"), std::string::npos) << waits.sentence;
}

TEST_F(RenderingLive, GoesOnWhereItsDeviceSaysWhatCannotBe) {
  begin(5);
  samples(20);
  msg::DeviceDescription none = stylus(5);
  none.mass_min_kg = std::numeric_limits<double>::quiet_NaN();
  descriptions.write(none);
  EXPECT_TRUE(says("the device's description is refused")) << report().message;
  samples(50);
  EXPECT_EQ(report().message.find("No force"), std::string::npos) << report().message;
  descriptions.write(stylus(9));  // its status says 5
  samples(100);
  EXPECT_EQ(planned, 5U) << "a session is what status and description name";
  session = 9;
  samples(50);
  for (const msg::ContactState& c : seen) ASSERT_EQ(c.session_id, 5U) << "no sample of another session is answered";
}

TEST_F(RenderingLive, RefusesASampleBeforeThatOfAnEarlierChange) {
  begin(5);
  samples(20);
  const std::uint64_t far = asker.send(change(kActionGain, 0.5, sequence + 1'000), "viscosity");
  refused(ask(change(kActionSwitch, 0.0, sequence + 500)), "a change asked for earlier waits for sample");
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

// --- the update server alone: an effect whose stiffness changes with its parameter

constexpr std::array kSpringParameters = {
    effects::EffectParameter{.name = "stiffness_n_per_m", .high = 1000.0, .standard = {{100.0, 0.0, 0.0}}}};

class Spring final : public effects::Effect {
 public:
  void apply(const effects::EffectFrame&, const effects::EffectValues& values, effects::EffectPush& push) noexcept override {
    push.stiffness_bound_n_per_m += values.number(0);
  }
};

const effects::EffectKind kSpring = {
    .name = "spring",
    .says = "",
    .equations = "",
    .parameters = kSpringParameters,
    .needs = [](const effects::EffectValues&) { return effects::EffectNeeds{}; },
    .bound =
        [](const effects::EffectValues& v) {
          effects::EffectBound bound;
          bound.stiffness_n_per_m = v.number(0);
          return bound;
        },
    .make = [] { return std::unique_ptr<effects::Effect>(std::make_unique<Spring>()); },
};

coupling::design::DeviceModel stylus() {
  coupling::design::DeviceModel model;
  model.name = "stylus";
  model.translation = {.inertia_min = 0.1, .inertia_max = 0.2, .damping = 2.0, .max_effort = 8.5};
  model.timing.delay_s = 1e-3;
  return model;
}

/// The update server's thread may be held up by whatever it does; a session begins without it.
TEST(SceneUpdateServer, IsNotWaitedForWhereASessionBegins) {
  const scene::Scene scene = scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
  const std::string rig = own_rig("w");
  const auto options = node_options<rendering_node::Options>(rig);
  const bus::Participant participant({kDomain, "lo", "update server"});
  rendering_node::ChangeLine line;
  std::atomic<bool> held{false}, go_on{false};
  std::atomic<std::uint64_t> last{0};
  rendering_node::SceneUpdateServer server(
      participant, options, scene, rendering::build_scene(scene, serial_for()), line, [](const scene::Scene&) {},
      [&](std::uint64_t session) {
        last = session, held = true;
        EXPECT_TRUE(wait_until([&] { return go_on.load(); })) << "device_is waits for the update server";
      });
  const auto begin = [&](std::uint64_t session) {
    server.device_is(std::make_unique<rendering_node::DescribedDevice>(rendering_node::DescribedDevice{session, stylus()}));
  };
  begin(3);
  ASSERT_TRUE(wait_until([&] { return held.load(); }));
  begin(4), begin(5);
  go_on = true;
  EXPECT_TRUE(wait_until([&] { return last == 5; })) << "the last one counts";
}

/// The update server of plane.yaml with one effect, a device and a loop that takes what is handed over.
class UpdateServer {
 public:
  UpdateServer(effects::EffectSpec effect, const coupling::design::DeviceModel& device)
      : name_(effect.name),
        scene_(plane_with(std::move(effect))),
        built_(rendering::build_scene(scene_, serial_for())),
        live_(*built_),
        of_contact(built_->plan().of_contact_alone.translation.all_points),
        rig_(own_rig("d")),
        options_(node_options<rendering_node::Options>(rig_)),
        participant_({kDomain, "lo", "update server"}),
        plans_(participant_, qos::kScenePlan, rig_, latched()),
        asker_(participant_, rig_),
        server_(
            participant_, options_, scene_, std::move(built_), line_, [](const scene::Scene&) {},
            [this](std::uint64_t session) { begun_ = session; }) {
    EXPECT_TRUE(asker_.ready());
    EXPECT_TRUE(asker_.send_until_heard(change(99), 1'000'000));
    line_.begin_session(3);
    server_.device_is(std::make_unique<rendering_node::DescribedDevice>(rendering_node::DescribedDevice{3, device}));
    EXPECT_TRUE(wait_until([&] { return begun_ == 3 && (loop(), !plans.empty()); }));
  }
  /// One sample, as the loop takes it, and the plans that have come.
  void loop() {
    line_.take(live_, ++sample_, true);
    effects::EffectFrame frame;
    frame.dt_s = 1e-3;
    live_.effects().apply(frame);
    plans_.take_each([&](const msg::ScenePlan& p) {
      plans.push_back({p.from_sample, p.all_points_stiffness_n_per_m, p.effects_damping_ns_per_m, p.effects_damping_nms_per_rad,
                       p.largest_damping_nms_per_rad, p.largest_turning_damping, p.largest_turning_damping_place});
    });
  }
  Said ask(const msg::EffectChange& m, const std::string& parameter) {
    return asker_.last_word(asker_.send(m, name_, parameter), [this] { loop(); });
  }
  /// What is answered at once, if only that it waits; the loop goes nowhere meanwhile.
  Said ask_and_wait(const msg::EffectChange& m, const std::string& parameter) {
    const std::uint64_t request = asker_.send(m, name_, parameter);
    EXPECT_TRUE(wait_until([&] {
      asker_.answers.take_each([&](const msg::EffectChanged& a) { asker_.said[a.request].push_back({a.result, a.from_sample, a.session_id, a.sentence}); });
      return !asker_.said[request].empty();
    }));
    return asker_.said[request].empty() ? Said{} : asker_.said[request].back();
  }
  void samples(int count) {
    for (int n = 0; n < count; ++n) loop(), std::this_thread::sleep_for(milliseconds(1));
  }

  struct Plan {
    std::uint64_t from_sample;
    double stiffness_n_per_m, damping_ns_per_m, damping_nms_per_rad, largest_nms_per_rad;
    std::string largest, place;
  };
  std::vector<Plan> plans;

 private:
  static scene::Scene plane_with(effects::EffectSpec effect) {
    scene::Scene scene = scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
    scene.effects = {std::move(effect)};
    return scene;
  }
  std::string name_;
  scene::Scene scene_;
  std::unique_ptr<rendering::BuiltScene> built_;
  rendering::LiveScene live_;

 public:
  const double of_contact;  ///< all points' stiffness [N/m]

 private:
  std::string rig_;
  rendering_node::Options options_;
  bus::Participant participant_;
  bus::Reader<msg::ScenePlan> plans_;
  Asker asker_;
  rendering_node::ChangeLine line_;
  std::atomic<std::uint64_t> begun_{0};
  rendering_node::SceneUpdateServer server_;
  std::uint64_t sample_ = 0;
};

TEST(SceneUpdateServer, PublishesThePlanAnewWhereTheStiffnessBoundChanges) {
  UpdateServer on({.name = "spring", .kind = &kSpring, .values = effects::EffectValues(kSpringParameters), .region = {}}, stylus());
  EXPECT_EQ(on.ask(change(kActionSwitch, 0.0), "").result, result::kResultDone);
  EXPECT_EQ(on.ask(change(kActionSwitch, 1.0), "").result, result::kResultDone);
  const Said stiffer = on.ask(change(kActionValue, 350.0), "stiffness_n_per_m");
  EXPECT_EQ(stiffer.result, result::kResultDone) << stiffer.sentence;
  const Said softer = on.ask(change(kActionValue, 50.0), "stiffness_n_per_m");
  ASSERT_TRUE(wait_until([&] { return on.loop(), on.plans.size() >= 3; }));
  ASSERT_EQ(on.plans.size(), 3U) << "the session's, and one for each change of the bound";
  EXPECT_EQ(on.plans[0].from_sample, 0U);
  EXPECT_NEAR(on.plans[0].stiffness_n_per_m, on.of_contact + 100.0, 1e-9);
  EXPECT_EQ(on.plans[1].from_sample, stiffer.from_sample);
  EXPECT_NEAR(on.plans[1].stiffness_n_per_m, on.of_contact + 350.0, 1e-9);
  EXPECT_EQ(on.plans[2].from_sample, softer.from_sample);
  EXPECT_NEAR(on.plans[2].stiffness_n_per_m, on.of_contact + 50.0, 1e-9);
}

// --- and one whose damping is a product: two numbers that change one after the other may meet where neither change comes to rest

constexpr std::array kPasteParameters = {
    effects::EffectParameter{.name = "share", .high = 10.0, .standard = {{2.0, 0.0, 0.0}}},
    effects::EffectParameter{.name = "thickness_ns_per_m", .high = 10.0, .standard = {{1.0, 0.0, 0.0}}},
    effects::EffectParameter{.name = "lever_m", .high = 1.0, .standard = {{0.0, 0.0, 0.0}}}};

class Paste final : public effects::Effect {
 public:
  void apply(const effects::EffectFrame&, const effects::EffectValues&, effects::EffectPush&) noexcept override {}
};

const effects::EffectKind kPaste = {
    .name = "paste",
    .says = "",
    .equations = "",
    .parameters = kPasteParameters,
    .needs = [](const effects::EffectValues&) { return effects::EffectNeeds{}; },
    .bound =
        [](const effects::EffectValues& v) {
          effects::EffectBound bound;
          bound.damping_ns_per_m = v.number(0) * v.number(1);
          bound.damping_nms_per_rad = bound.damping_ns_per_m * v.number(2) * v.number(2);
          return bound;
        },
    .make = [] { return std::unique_ptr<effects::Effect>(std::make_unique<Paste>()); },
};

effects::EffectSpec paste(double lever_m = 0.0) {
  effects::EffectSpec spec{.name = "paste", .kind = &kPaste, .values = effects::EffectValues(kPasteParameters), .region = {}};
  spec.values.at(2)[0] = lever_m;
  spec.place = "a.yaml:7:5";
  return spec;
}

TEST(SceneUpdateServer, JudgesWhatTwoChangesMayComeToOnTheirWay) {
  UpdateServer on(paste(), stylus());
  EXPECT_EQ(on.ask(change(kActionValue, 0.2), "share").result, result::kResultDone);
  const Said thicker = on.ask(change(kActionValue, 9.0), "thickness_ns_per_m");
  EXPECT_EQ(thicker.result, result::kResultRefused) << "2 * 9 Ns/m may be felt before the share is down";
  EXPECT_NE(thicker.sentence.find("on the way"), std::string::npos) << thicker.sentence;
  on.samples(400);
  EXPECT_EQ(on.ask(change(kActionValue, 9.0), "thickness_ns_per_m").result, result::kResultDone) << "it has settled";
}

TEST(SceneUpdateServer, JudgesWhatTwoChangesThatWaitMayComeToOnTheirWay) {
  UpdateServer on(paste(), stylus());
  EXPECT_EQ(on.ask_and_wait(change(kActionValue, 0.2, 5'000), "share").result, result::kResultWaiting);
  const Said thicker = on.ask_and_wait(change(kActionValue, 9.0, 5'000), "thickness_ns_per_m");
  EXPECT_EQ(thicker.result, result::kResultRefused) << "2 * 9 Ns/m may be felt before the share is down";
  EXPECT_NE(thicker.sentence.find("on the way"), std::string::npos) << thicker.sentence;
}

TEST(SceneUpdateServer, TellsWhatTheEffectsDampOfTurning) {
  coupling::design::DeviceModel arm = stylus();
  arm.gives_torque = true;
  arm.rotation = {.inertia_min = 0.01, .inertia_max = 0.02, .damping = 0.2, .max_effort = 5.0, .max_stiffness = 50.0};
  UpdateServer on(paste(0.05), arm);
  EXPECT_NEAR(on.plans[0].damping_ns_per_m, 2.0, 1e-12);
  EXPECT_NEAR(on.plans[0].damping_nms_per_rad, 0.005, 1e-12);
  EXPECT_NEAR(on.plans[0].largest_nms_per_rad, 0.005, 1e-12);
  EXPECT_EQ(on.plans[0].largest, "paste");
  EXPECT_EQ(on.plans[0].place, "a.yaml:7:5");
}

}  // namespace
}  // namespace voxtouch::test
