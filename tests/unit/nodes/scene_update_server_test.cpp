// The update server alone: what it passes to the loop, what it refuses, and what it reports to the
// coupling.
#include "nodes/rendering/scene_update_server.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/scene/scene_file.hpp"
#include "tests/unit/nodes/asker.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds;
using namespace msg::effect_change;
namespace result = msg::effect_changed;

/// An effect without a law: only the bounds of its kind matter.
class Idle final : public effects::Effect {
 public:
  void apply(const effects::EffectFrame&, const effects::EffectValues&,
             effects::EffectForce&) noexcept override {}
};

effects::EffectKind idle_kind(std::string_view name,
                              std::span<const effects::EffectParameter> parameters,
                              effects::EffectBound (*bound)(const effects::EffectValues&)) {
  return {.name = name,
          .summary = "",
          .equations = "",
          .parameters = parameters,
          .needs = [](const effects::EffectValues&) { return effects::EffectNeeds{}; },
          .bound = bound,
          .make = [] { return std::unique_ptr<effects::Effect>(std::make_unique<Idle>()); }};
}

constexpr std::array kSpringParameters = {effects::EffectParameter{
    .name = "stiffness_n_per_m", .high = 1000.0, .standard = {{100.0, 0.0, 0.0}}}};
const effects::EffectKind kSpring =
    idle_kind("spring", kSpringParameters, [](const effects::EffectValues& v) {
      effects::EffectBound bound;
      bound.stiffness_n_per_m = v.number(0);
      return bound;
    });

/// Its damping is a product: two numbers that change one after the other may combine to an
/// intermediate maximum.
constexpr std::array kPasteParameters = {
    effects::EffectParameter{.name = "share", .high = 10.0, .standard = {{2.0, 0.0, 0.0}}},
    effects::EffectParameter{
        .name = "thickness_ns_per_m", .high = 10.0, .standard = {{1.0, 0.0, 0.0}}},
    effects::EffectParameter{.name = "lever_m", .high = 1.0, .standard = {{0.0, 0.0, 0.0}}}};
const effects::EffectKind kPaste =
    idle_kind("paste", kPasteParameters, [](const effects::EffectValues& v) {
      effects::EffectBound bound;
      bound.damping_ns_per_m = v.number(0) * v.number(1);
      bound.damping_nms_per_rad = bound.damping_ns_per_m * v.number(2) * v.number(2);
      return bound;
    });

coupling::design::DeviceModel stylus() {
  coupling::design::DeviceModel model;
  model.name = "stylus";
  model.translation = {.inertia_min = 0.1, .inertia_max = 0.2, .damping = 2.0, .max_effort = 8.5};
  model.timing.delay_s = 1e-3;
  return model;
}

/// The update server's thread may be blocked; a session begins without it.
TEST(SceneUpdateServer, DoesNotDelayANewSession) {
  const scene::Scene scene = scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
  const std::string rig = own_rig("w");
  const auto options = node_options<rendering_node::Options>(rig);
  const bus::Participant participant({kDomain, "lo", "update server"});
  rendering_node::ChangeQueue line;
  std::atomic<bool> waiting{false}, go_on{false};
  std::atomic<std::uint64_t> last{0};
  rendering_node::SceneUpdateServer server(
      participant, options, scene, rendering::build_scene(scene, serial_for()), line,
      [](const scene::Scene&) {},
      [&](std::uint64_t session) {
        last = session, waiting = true;
        EXPECT_TRUE(wait_until([&] { return go_on.load(); }))
            << "set_device waits for the update server";
      });
  const auto begin = [&](std::uint64_t session) {
    server.set_device(std::make_unique<rendering_node::DescribedDevice>(
        rendering_node::DescribedDevice{session, stylus()}));
  };
  begin(3);
  ASSERT_TRUE(wait_until([&] { return waiting.load(); }));
  begin(4), begin(5);
  go_on = true;
  EXPECT_TRUE(wait_until([&] { return last == 5; })) << "the last one counts";
}

/// The update server of plane.yaml with one effect, a device and a loop that takes its changes.
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
    EXPECT_TRUE(asker_.send_until_received(change(99), 1'000'000));
    line_.begin_session(3);
    server_.set_device(std::make_unique<rendering_node::DescribedDevice>(
        rendering_node::DescribedDevice{3, device}));
    EXPECT_TRUE(wait_until([&] { return begun_ == 3 && (loop(), !plans.empty()); }));
  }
  /// One sample, as the loop takes it, and the plans received.
  void loop() {
    line_.apply_due(live_, ++sample_, true);
    effects::EffectFrame frame;
    frame.dt_s = 1e-3;
    live_.effects().apply(frame);
    plans_.take_each([&](const msg::ScenePlan& p) {
      plans.push_back({p.from_sample, p.all_points_stiffness_n_per_m, p.effects_damping_ns_per_m,
                       p.effects_damping_nms_per_rad, p.largest_damping_nms_per_rad,
                       p.largest_rotation_damping, p.largest_rotation_damping_place});
    });
  }
  Said ask(const msg::EffectChange& m, const std::string& parameter) {
    return asker_.last_word(asker_.send(m, name_, parameter), [this] { loop(); });
  }
  /// The immediate reply, possibly PENDING; the loop does not run meanwhile.
  Said ask_and_wait(const msg::EffectChange& m, const std::string& parameter) {
    return asker_.first_word(asker_.send(m, name_, parameter));
  }
  void samples(int count) {
    for (int n = 0; n < count; ++n)
      loop(), std::this_thread::sleep_for(milliseconds(1));
  }
  /// Sent without a number, as from a shell.
  void deliver(msg::EffectChange m, std::string parameter) {
    m.effect = runtime::lend(name_), m.parameter = runtime::lend(parameter),
    m.model = runtime::lend(none_);
    asker_.changes.write(m);
  }

  struct Made {
    std::uint64_t request, session, from_sample;
    std::uint32_t action;
    std::string effect, parameter;
    double value;
    bool operator==(const Made&) const = default;
  };
  /// The records of changes, as a recorder that starts now receives them.
  std::vector<Made> records(std::size_t count) {
    bus::Reader<msg::EffectChange> reader(participant_, qos::kEffectMade, rig_,
                                          qos::profile(qos::kEffectMade.profile));
    std::vector<Made> all;
    EXPECT_TRUE(wait_until([&] {
      loop();
      reader.take_each([&](const msg::EffectChange& m) {
        all.push_back(
            {m.request, m.session_id, m.from_sample, m.action, m.effect, m.parameter, m.value[0]});
      });
      return all.size() >= count;
    }));
    return all;
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
  std::string name_, none_;
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
  rendering_node::ChangeQueue line_;
  std::atomic<std::uint64_t> begun_{0};
  rendering_node::SceneUpdateServer server_;
  std::uint64_t sample_ = 0;
};

TEST(SceneUpdateServer, RepublishesThePlanForANewStiffnessBound) {
  UpdateServer on({.name = "spring",
                   .kind = &kSpring,
                   .values = effects::EffectValues(kSpringParameters),
                   .region = {}},
                  stylus());
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

/// A bag with these records replays every change, for any sender, even if the recorder missed the
/// request.
TEST(SceneUpdateServer, RecordsAppliedChangesAlsoForLateRecorders) {
  UpdateServer on({.name = "spring",
                   .kind = &kSpring,
                   .values = effects::EffectValues(kSpringParameters),
                   .region = {}},
                  stylus());
  const Said off = on.ask(change(kActionSwitch, 0.0), "");
  EXPECT_EQ(on.ask(change(kActionGain, 7.0), "").result, result::kResultRefused);
  const Said stiffer = on.ask(change(kActionValue, 350.0), "stiffness_n_per_m");
  ASSERT_EQ(stiffer.result, result::kResultDone) << stiffer.sentence;
  on.deliver(change(kActionGain, 0.5), "");
  const std::vector<UpdateServer::Made> records = on.records(3);
  ASSERT_EQ(records.size(), 3U);
  EXPECT_EQ(records[0],
            (UpdateServer::Made{1, 3, off.from_sample, kActionSwitch, "spring", "", 0.0}));
  EXPECT_EQ(records[1], (UpdateServer::Made{3, 3, stiffer.from_sample, kActionValue, "spring",
                                            "stiffness_n_per_m", 350.0}));
  EXPECT_EQ(records[2],
            (UpdateServer::Made{0, 3, records[2].from_sample, kActionGain, "spring", "", 0.5}))
      << "asked for without a number";
  EXPECT_GT(records[2].from_sample, stiffer.from_sample);
}

effects::EffectSpec paste(double lever_m = 0.0) {
  effects::EffectSpec spec{.name = "paste",
                           .kind = &kPaste,
                           .values = effects::EffectValues(kPasteParameters),
                           .region = {}};
  spec.values.at(2)[0] = lever_m;
  spec.place = "a.yaml:7:5";
  return spec;
}

TEST(SceneUpdateServer, ChecksTheTransitionOfTwoChanges) {
  UpdateServer on(paste(), stylus());
  EXPECT_EQ(on.ask(change(kActionValue, 0.2), "share").result, result::kResultDone);
  const Said thicker = on.ask(change(kActionValue, 9.0), "thickness_ns_per_m");
  EXPECT_EQ(thicker.result, result::kResultRefused)
      << "2 * 9 Ns/m may be displayed before the fraction is down";
  on.samples(400);
  EXPECT_EQ(on.ask(change(kActionValue, 9.0), "thickness_ns_per_m").result, result::kResultDone)
      << "it has settled";
}

TEST(SceneUpdateServer, ChecksTheTransitionOfTwoPendingChanges) {
  UpdateServer on(paste(), stylus());
  EXPECT_EQ(on.ask_and_wait(change(kActionValue, 0.2, 5'000), "share").result,
            result::kResultPending);
  const Said thicker = on.ask_and_wait(change(kActionValue, 9.0, 5'000), "thickness_ns_per_m");
  EXPECT_EQ(thicker.result, result::kResultRefused)
      << "2 * 9 Ns/m may be displayed before the fraction is down";
}

TEST(SceneUpdateServer, ReportsTheEffectsRotationDamping) {
  coupling::design::DeviceModel arm = stylus();
  arm.gives_torque = true;
  arm.rotation = {.inertia_min = 0.01,
                  .inertia_max = 0.02,
                  .damping = 0.2,
                  .max_effort = 5.0,
                  .max_stiffness = 50.0};
  UpdateServer on(paste(0.05), arm);
  EXPECT_NEAR(on.plans[0].damping_ns_per_m, 2.0, 1e-12);
  EXPECT_NEAR(on.plans[0].damping_nms_per_rad, 0.005, 1e-12);
  EXPECT_NEAR(on.plans[0].largest_nms_per_rad, 0.005, 1e-12);
  EXPECT_EQ(on.plans[0].largest, "paste");
  EXPECT_EQ(on.plans[0].place, "a.yaml:7:5");
}

/// Without DDS, a thread or a clock.
class ValidatorOfChanges : public testing::Test {
 protected:
  ValidatorOfChanges() { scene_.effects = {paste()}; }
  std::expected<std::vector<rendering_node::PendingChange>, std::string> judge(
      double value, const char* parameter) {
    msg::EffectChange m = change(kActionValue, value);
    std::string name = "paste", of = parameter;
    m.effect = runtime::lend(name), m.parameter = runtime::lend(of);
    return validator().judge(std::span(&m, 1), {{}}, pending_);
  }
  std::string check(msg::EffectChange m, std::uint64_t sample = 0) {
    static std::string none;
    m.effect = m.parameter = m.model = runtime::lend(none);
    return validator().check(m, 3, sample, pending_);
  }
  rendering_node::ChangeValidator& validator() {
    if (!validator_) {
      built_ = rendering::build_scene(scene_, serial_for());
      validator_.emplace(scene_, *built_);
      validator_->set_device(stylus());
      validator_->judge_running();
    }
    return *validator_;
  }

  scene::Scene scene_ = scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
  std::unique_ptr<rendering::BuiltScene> built_;
  std::optional<rendering_node::ChangeValidator> validator_;
  rendering_node::PendingChanges pending_;
  rendering_node::ChangeQueue line_;
};

TEST_F(ValidatorOfChanges, ChecksAfterPendingChanges) {
  auto less = judge(0.2, "share");
  ASSERT_TRUE(less) << less.error();
  EXPECT_TRUE(judge(4.0, "thickness_ns_per_m")) << "8 Ns/m alone";
  EXPECT_FALSE(judge(9.0, "thickness_ns_per_m")) << "18 Ns/m";
  ASSERT_TRUE(pending_.hand_over(std::move(*less), line_));
  EXPECT_FALSE(judge(9.0, "thickness_ns_per_m")) << "both may meet on their way";
  rendering_node::PendingChange done = pending_.take();
  validator().apply(done);
  EXPECT_FALSE(validator().sum_up()) << "the effect may still be where it was";
  validator().come_to_rest();
  EXPECT_TRUE(validator().sum_up());
  EXPECT_NEAR(validator().demand().damping.all, 0.2, 1e-12);
  EXPECT_TRUE(judge(9.0, "thickness_ns_per_m")) << "1.8 Ns/m";
}

TEST_F(ValidatorOfChanges, RefusesInvalidRequests) {
  EXPECT_EQ(check(change(kActionSwitch, 1.0, 10'000)), "");
  EXPECT_NE(check(change(kActionSwitch, 1.0, 10'001)), "") << "more than 10 s of 1 kHz away";
  EXPECT_EQ(check(change(kActionSwitch, 1.0, 10'001), 1), "");
  EXPECT_NE(check(change(0, 1.0)), "") << "there is no such action";
  msg::EffectChange of_another = change(kActionSwitch, 1.0);
  of_another.session_id = 4;
  EXPECT_NE(check(of_another), "");
}

TEST_F(ValidatorOfChanges, RefusesASampleBeforeAnEarlierChange) {
  rendering_node::PendingChange waits;
  waits.request.from_sample = 500;
  ASSERT_TRUE(pending_.hand_over({waits}, line_));
  EXPECT_NE(check(change(kActionSwitch, 1.0, 499)), "");
  EXPECT_EQ(check(change(kActionSwitch, 1.0, 500)), "");
  ASSERT_TRUE(pending_.hand_over({{}}, line_));
  EXPECT_EQ(pending_.last_sample(), 500U) << "one that goes at once goes behind it";
}

}  // namespace
}  // namespace voxtouch::test
