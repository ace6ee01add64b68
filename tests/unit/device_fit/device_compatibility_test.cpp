// Run-time changes are checked for the device by the code of the start.
#include "core/device_fit/device_compatibility.hpp"

#include <gtest/gtest.h>

#include "core/rendering/reload_check.hpp"
#include "core/scene/scene_file.hpp"
#include "nodes/design_text/design_text.hpp"

namespace voxtouch::device_fit {

using design_text::sentence_of;
namespace device_compatibility_test {

constexpr rendering::StiffnessBounds kContact = {{30.0, 3000.0}, {0.003, 0.3}};

/// As the simulated Phantom.
coupling::design::DeviceModel stylus(double mass_kg = 0.1) {
  coupling::design::DeviceModel model;
  model.name = "stylus";
  model.translation = {.inertia_min = mass_kg,
                       .inertia_max = 2.0 * mass_kg,
                       .damping = 2.0,
                       .resolution = 3e-5,
                       .max_effort = 8.5,
                       .max_stiffness = 800.0};
  model.timing.delay_s = 1e-3;
  return model;
}
coupling::design::DeviceModel arm() {
  coupling::design::DeviceModel model = stylus(2.0);
  model.name = "arm";
  model.gives_torque = true;
  model.rotation = {.inertia_min = 0.01,
                    .inertia_max = 0.02,
                    .damping = 0.05,
                    .resolution = 1e-5,
                    .max_effort = 5.0,
                    .max_stiffness = 50.0};
  return model;
}

effects::EffectSpec effect(const char* kind, std::initializer_list<double> first) {
  effects::EffectSpec spec{
      .name = kind, .kind = effects::find_effect_kind(kind), .values = {}, .region = {}};
  spec.values = effects::EffectValues(spec.kind->parameters);
  std::size_t n = 0;
  for (const double value : first)
    spec.values.at(n++)[0] = value;
  spec.place = "a.yaml:7:5";
  return spec;
}
effects::EffectSpec oil(double damping, double rotation_damping = 0.0) {
  return effect("viscosity", {damping, rotation_damping});
}

scene::Scene scene_with(std::vector<effects::EffectSpec> effects) {
  scene::Scene scene = scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
  scene.effects = std::move(effects);
  return scene;
}
scene::Scene by_hand(std::vector<effects::EffectSpec> effects) {
  scene::Scene scene = scene_with(std::move(effects));
  scene.design.reset();
  return scene;
}
rendering::StiffnessBounds bounds(const scene::Scene& scene) {
  return rendering::with_effects(kContact, scene.effects);
}

/// Result of the check at the start.
std::string at_start(const scene::Scene& scene, const coupling::design::DeviceModel& device) {
  return sentence_of(
      fit_coupling(scene, device, bounds(scene).translation, bounds(scene).rotation).refusal);
}
DeviceCompatibility running(const scene::Scene& scene,
                            const coupling::design::DeviceModel& device) {
  DeviceCompatibility on;
  on.set_device(device);
  on.runs(scene, kContact, bounds(scene), demand_of(scene));
  return on;
}
std::string asked(DeviceCompatibility& on, const scene::Scene& next) {
  return sentence_of(on.check(next, kContact, effects::at_rest(next.effects)));
}

/// The largest damping that this device tolerates with this contact, by the check at the start.
double most_damping(const coupling::design::DeviceModel& device) {
  double low = 0.0, high = 100.0;
  while (high - low > 1e-6)
    (at_start(scene_with({oil(0.5 * (low + high))}), device).empty() ? low : high) =
        0.5 * (low + high);
  return low;
}

TEST(DeviceCompatibility, RefusesLikeTheStartInTheSameWords) {
  const scene::Scene now = scene_with({oil(0.5)});
  DeviceCompatibility on = running(now, stylus());
  ASSERT_EQ(sentence_of(on.refusal()), "");
  int accepted = 0, refused = 0;
  for (double damping = 0.25; damping < 100.0; damping *= 1.3) {
    const scene::Scene next = scene_with({oil(damping)});
    const std::string start = at_start(next, stylus());
    EXPECT_EQ(asked(on, next), start) << damping;
    (start.empty() ? accepted : refused)++;
  }
  EXPECT_GT(accepted, 2);
  EXPECT_GT(refused, 5);
}

TEST(DeviceCompatibility, ChecksTheSumOfAllEffects) {
  const double most = most_damping(stylus());
  const scene::Scene now = scene_with({oil(0.6 * most), effect("surface_damping", {0.3 * most})});
  DeviceCompatibility on = running(now, stylus());
  ASSERT_EQ(sentence_of(on.refusal()), "");
  scene::Scene next = now;
  next.effects[1].values.at(0)[0] = 0.5 * most;
  EXPECT_NE(asked(on, next), "");
  EXPECT_EQ(asked(on, next), at_start(next, stylus()));
}

TEST(DeviceCompatibility, CountsDisabledEffectsAtFullGain) {
  const double most = most_damping(stylus());
  scene::Scene off = scene_with({oil(1.5 * most)});
  off.effects[0].on = false;
  EXPECT_NE(at_start(off, stylus()), "");
  off.effects[0].on = true, off.effects[0].gain = 0.1;
  EXPECT_NE(at_start(off, stylus()), "");
  scene::Scene now = scene_with({oil(0.5 * most)});
  now.effects[0].on = false, now.effects[0].gain = 0.1;
  DeviceCompatibility on = running(now, stylus());
  EXPECT_NE(asked(on, off), "") << "a value that is too much is refused also where the gain is low";
  now.effects[0].on = true, now.effects[0].gain = 1.0;
  EXPECT_EQ(asked(on, now), "");
}

/// The first effect is still decreasing from nearly the limit when the second one starts to rise.
TEST(DeviceCompatibility, ChecksValuesDuringTheirTransition) {
  const double most = most_damping(stylus());
  const scene::Scene now = scene_with({oil(0.9 * most), effect("surface_damping", {0.05 * most})});
  DeviceCompatibility on = running(now, stylus());
  scene::Scene next = scene_with({oil(0.05 * most), effect("surface_damping", {0.9 * most})});
  ASSERT_EQ(at_start(next, stylus()), "");
  std::vector<effects::EffectReach> reach = effects::at_rest(now.effects);
  reach[0].widen(next.effects[0]), reach[1].widen(next.effects[1]);
  EXPECT_NE(sentence_of(on.check(next, kContact, reach)), "");
  scene::Scene lower = now;
  lower.effects[0] = next.effects[0];
  on.runs(lower, kContact, bounds(lower), demand_of(lower));
  EXPECT_EQ(asked(on, next), "") << "once the first one has come to rest";
}

/// A coupling is refitted some tenths of a second after the contact has changed: damping must be
/// valid with both.
TEST(DeviceCompatibility, ChecksDampingOnCurrentAndNextCoupling) {
  const auto lag = [](const rendering::StiffnessBounds& bounds) {
    return coupling::lag_s(fit_coupling(scene_with({}), stylus(), bounds, {}).spec);
  };
  rendering::StiffnessBounds soft = kContact, stiff = kContact;
  soft.translation = {0.3, 30.0};
  ASSERT_GT(lag(soft), 1.2 * lag(stiff)) << "a soft contact may be filtered more";
  const double most = most_damping(stylus());
  const scene::Scene scene = scene_with({oil(0.95 * most)});
  DeviceCompatibility on = running(scene, stylus());
  ASSERT_EQ(sentence_of(on.refusal()), "");
  EXPECT_NE(sentence_of(on.check(scene, soft, effects::at_rest(scene.effects))), "")
      << "the coupling that follows lags more";
  const scene::Scene thin = scene_with({});
  on.runs(thin, soft, soft, demand_of(thin));
  EXPECT_NE(sentence_of(on.check(scene, kContact, effects::at_rest(scene.effects))), "")
      << "the one that runs still lags more";
}

/// Decreasing damping is displayed until it has decreased; the next coupling may be active earlier.
TEST(DeviceCompatibility, ChecksTheTransitionOnTheNextCoupling) {
  rendering::StiffnessBounds soft = kContact;
  soft.translation = {0.3, 30.0};
  const scene::Scene scene = scene_with({oil(0.95 * most_damping(stylus()))}),
                     thin = scene_with({oil(0.1)});
  DeviceCompatibility on = running(scene, stylus());
  ASSERT_EQ(sentence_of(on.refusal()), "");
  ASSERT_EQ(sentence_of(on.check(thin, kContact, effects::at_rest(thin.effects))), "")
      << "with the lag as it is";
  EXPECT_NE(sentence_of(on.check(thin, soft, effects::at_rest(thin.effects))), "")
      << "the one that follows lags more";
  on.runs(thin, kContact, kContact, demand_of(thin));
  EXPECT_EQ(sentence_of(on.check(thin, soft, effects::at_rest(thin.effects))), "")
      << "once it has settled";
}

TEST(DeviceCompatibility, RefusesTorqueOnADeviceWithoutTorque) {
  const scene::Scene now = scene_with({oil(0.5)}), next = scene_with({oil(0.5, 0.01)});
  DeviceCompatibility on = running(now, stylus());
  EXPECT_NE(asked(on, next), "");
  EXPECT_EQ(asked(on, next), at_start(next, stylus()));
  DeviceCompatibility on_arm = running(now, arm());
  ASSERT_EQ(sentence_of(on_arm.refusal()), "");
  EXPECT_EQ(asked(on_arm, next), "");
}

TEST(DeviceCompatibility, ChecksRotationDampingLikeTranslation) {
  const auto rotation_damping = [](double a, double b = 0.0) {
    return scene_with({oil(0.5, a), oil(0.5, b)});
  };
  double most = 0.0, high = 100.0;
  while (high - most > 1e-6)
    (at_start(rotation_damping(0.5 * (most + high)), arm()).empty() ? most : high) =
        0.5 * (most + high);
  ASSERT_GT(most, 0.01);
  const scene::Scene now = rotation_damping(0.9 * most),
                     next = rotation_damping(0.6 * most, 0.5 * most),
                     other = rotation_damping(0.05 * most, 0.9 * most);
  DeviceCompatibility on = running(now, arm());
  ASSERT_EQ(sentence_of(on.refusal()), "");
  EXPECT_NE(asked(on, next), "");
  EXPECT_EQ(asked(on, next), at_start(next, arm()));
  EXPECT_EQ(asked(on, rotation_damping(0.95 * most)), "");
  std::vector<effects::EffectReach> reach = effects::at_rest(now.effects);
  reach[0].widen(other.effects[0]), reach[1].widen(other.effects[1]);
  EXPECT_NE(sentence_of(on.check(other, kContact, reach)), "");
  DeviceCompatibility still = running(next, arm());
  EXPECT_EQ(sentence_of(still.refusal()), at_start(next, arm()));
  EXPECT_NE(asked(still, rotation_damping(0.7 * most, 0.6 * most)), "")
      << "it demands more of what is too much already";
}

TEST(DeviceCompatibility, RefusesStiffnessBeyondAManualCoupling) {
  const auto guide = [](double stiffness) {
    effects::EffectSpec spec = effect("guide_point", {});
    for (std::size_t n = 0; n < spec.kind->parameters.size(); ++n) {
      if (spec.kind->parameters[n].name == "stiffness_n_per_m")
        spec.values.at(n)[0] = stiffness;
      if (spec.kind->parameters[n].name == "limit_n")
        spec.values.at(n)[0] = 2;
    }
    return spec;
  };
  const scene::Scene now = by_hand({guide(100)}), next = by_hand({guide(5000)});
  DeviceCompatibility on = running(now, stylus());
  ASSERT_EQ(sentence_of(on.refusal()), "");
  EXPECT_NE(asked(on, next).find("5000 N/m"), std::string::npos) << asked(on, next);
  EXPECT_EQ(asked(on, next), at_start(next, stylus()));
  scene::Scene stiffer = now;
  stiffer.contact.stiffness_n_per_m = 900.0;
  EXPECT_NE(asked(on, stiffer).find("contact.stiffness_n_per_m"), std::string::npos)
      << asked(on, stiffer);
}

TEST(DeviceCompatibility, ChecksAgainForAnotherDevice) {
  const double most = most_damping(stylus());
  const scene::Scene now = scene_with({oil(0.9 * most)});
  DeviceCompatibility on = running(now, stylus());
  ASSERT_EQ(sentence_of(on.refusal()), "");
  coupling::design::DeviceModel late = stylus();
  late.timing.delay_s = 0.05;
  for (const coupling::design::DeviceModel& other : {stylus(0.01), late}) {
    on.set_device(other);
    on.runs(now, kContact, bounds(now), demand_of(now));
    EXPECT_NE(sentence_of(on.refusal()), "");
    EXPECT_EQ(sentence_of(on.refusal()), at_start(now, other));
  }
  on.set_device(arm());
  on.runs(now, kContact, bounds(now), demand_of(now));
  EXPECT_EQ(sentence_of(on.refusal()), at_start(now, arm()))
      << "another kind of device, whose session begins";
}

TEST(DeviceCompatibility, AcceptsAllUntilADeviceIsKnown) {
  DeviceCompatibility on;
  const scene::Scene thick = scene_with({oil(50.0)});
  on.runs(scene_with({oil(1.0)}), kContact, kContact, {});
  EXPECT_EQ(asked(on, thick), "");
  on.runs(thick, kContact, bounds(thick), demand_of(thick));
  EXPECT_EQ(sentence_of(on.refusal()), "");
  on.set_device(stylus());
  on.runs(thick, kContact, bounds(thick), demand_of(thick));
  EXPECT_EQ(sentence_of(on.refusal()), at_start(thick, stylus()));
}

/// No force is commanded then, so smaller requirements are accepted.
TEST(DeviceCompatibility, AcceptsALowerDemandIfNoForceIsCommanded) {
  const scene::Scene two = scene_with({oil(50.0), effect("surface_damping", {50.0})});
  DeviceCompatibility on = running(two, stylus());
  ASSERT_NE(sentence_of(on.refusal()), "");
  scene::Scene one = two;
  one.effects[0].values.at(0)[0] = 1.0;
  EXPECT_EQ(asked(on, one), "") << "the other one is still too much, but must be lowered somehow";
  scene::Scene more = two;
  more.effects[0].values.at(0)[0] = 60.0;
  EXPECT_NE(asked(on, more), "");
}

TEST(DeviceCompatibility, RefusesNanAndInfinity) {
  const scene::Scene scene = scene_with({oil(0.5)});
  const scene::Scene hand = by_hand({});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const scene::Scene& s, double one_point,
                          const SceneRequirements& demand) {
    const rendering::StiffnessBounds bounds{{one_point, 3000.0}, {0.003, 0.3}};
    return !fit_coupling(s, stylus(), bounds, demand).refusal.empty();
  };
  for (const double bad : {nan, -1.0, std::numeric_limits<double>::infinity()}) {
    SceneRequirements demand, rotation_damping;
    demand.damping.all = rotation_damping.rotation.all = bad;
    EXPECT_TRUE(refused(scene, 30.0, demand)) << bad;
    EXPECT_FALSE(fit_coupling(scene, arm(), kContact, rotation_damping).refusal.empty()) << bad;
    EXPECT_TRUE(refused(hand, bad, {})) << bad;
  }
  SceneRequirements stiff;
  stiff.least_stiffness_n_per_m = nan;
  EXPECT_TRUE(refused(hand, 30.0, stiff));
  EXPECT_FALSE(refused(scene, 30.0, {}));
  EXPECT_FALSE(refused(hand, 30.0, {}));
}

TEST(SceneRequirements, OfTwoScenesThatFadeIsTheLargerOfEachFigure) {
  const SceneRequirements a = demand_of(by_hand({oil(5.0)})),
                          b = demand_of(by_hand({oil(1.0, 0.1), effect("magnet", {0, 0.001, 3})}));
  const SceneRequirements both = larger_of(a, b);
  EXPECT_EQ(both.damping.all, 5.0);
  EXPECT_EQ(both.damping.largest, 5.0);
  EXPECT_EQ(both.rotation.all, 0.1);
  EXPECT_EQ(both.least_stiffness_n_per_m, b.least_stiffness_n_per_m);
  EXPECT_EQ(both.torque, "viscosity");
  EXPECT_TRUE(larger_of(b, a) == both);
}

}  // namespace device_compatibility_test
}  // namespace voxtouch::device_fit
