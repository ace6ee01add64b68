// A virtual tool's spring: as stiff as device and certificates permit, checked at the start and at
// each change by the same code.
#include <gtest/gtest.h>

#include "core/device_fit/design_problem.hpp"
#include "core/device_fit/device_compatibility.hpp"
#include "core/scene/scene_file.hpp"
#include "nodes/design_text/design_text.hpp"

namespace voxtouch::device_fit {

using design_text::sentence_of;
namespace spring_test {

constexpr double kLever = 0.01;

coupling::design::DeviceModel stylus() {
  coupling::design::DeviceModel model;
  model.name = "stylus";
  model.translation = {.inertia_min = 0.1,
                       .inertia_max = 0.2,
                       .damping = 2.0,
                       .resolution = 3e-5,
                       .max_effort = 8.5,
                       .max_stiffness = 800.0};
  model.timing.delay_s = 1e-3;
  return model;
}
coupling::design::DeviceModel arm() {
  coupling::design::DeviceModel model = stylus();
  model.name = "arm";
  model.translation.inertia_min = 2.0, model.translation.inertia_max = 4.0;
  model.gives_torque = true;
  model.rotation = {.inertia_min = 0.01,
                    .inertia_max = 0.02,
                    .damping = 0.05,
                    .resolution = 1e-5,
                    .max_effort = 5.0,
                    .max_stiffness = 50.0};
  return model;
}
scene::Scene scene_of(const std::string& kind = "shaping_filter") {
  scene::Scene scene = scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
  scene.contact = {.model = "field", .rendering = scene::RenderingKind::kVirtualTool};
  scene.design->kind = kind;
  return scene;
}
effects::EffectSpec oil(double damping) {
  effects::EffectSpec spec{
      .name = "oil", .kind = effects::find_effect_kind("viscosity"), .values = {}, .region = {}};
  spec.values = effects::EffectValues(spec.kind->parameters);
  spec.values.at(0)[0] = damping;
  return spec;
}
FittedCoupling fit(const scene::Scene& scene, const coupling::design::DeviceModel& device,
                   double lever = kLever) {
  return fit_coupling(scene, device, rendering::spring_of_any_device(lever), demand_of(scene));
}

TEST(Spring, IsTheWholeCertifiedStiffness) {
  for (const char* kind : {"shaping_filter", "direct"})
    for (const coupling::design::DeviceModel& device : {stylus(), arm()}) {
      const scene::Scene scene = scene_of(kind);
      const FittedCoupling fitted = fit(scene, device);
      ASSERT_EQ(sentence_of(fitted.refusal), "") << kind;
      const double spring =
          spring_n_per_m(fitted, scene, device, rendering::spring_of_any_device(kLever));
      EXPECT_NEAR(spring, fitted.design.translation.displayed_stiffness, 1e-6 * spring)
          << kind << " " << device.name;
      EXPECT_LE(spring, fitted.spec.stiffness_cap_n_per_m);
      EXPECT_LE(spring * kLever * kLever, fitted.spec.stiffness_cap_nm_per_rad * (1 + 1e-12));
      EXPECT_EQ(fitted.spec.kind == "shaping_filter" ? fitted.spec.gain : 1.0, 1.0)
          << "the cap does it, and no effect is made weaker";
      EXPECT_GE(fitted.design.translation.gain_margin, 2.0 - 1e-6);
      EXPECT_GT(spring, 50.0);
    }
}

TEST(Spring, LeavesRoomForEffectsBelowTheCap) {
  scene::Scene scene = scene_of();
  effects::EffectSpec guide{.name = "guide",
                            .kind = effects::find_effect_kind("guide_plane"),
                            .values = {},
                            .region = {}};
  guide.values = effects::EffectValues(guide.kind->parameters);
  guide.values.at(0) = {0, 0, 0};
  for (std::size_t p = 0; p < guide.values.size(); ++p) {
    const std::string_view name = guide.kind->parameters[p].name;
    if (name == "normal")
      guide.values.at(p) = {0, 0, 1};
    if (name == "stiffness_n_per_m")
      guide.values.at(p)[0] = 60.0;
    if (name == "limit_n")
      guide.values.at(p)[0] = 3.0;
  }
  const rendering::StiffnessBounds alone = rendering::spring_of_any_device(kLever),
                                   all = rendering::with_effects(alone, std::vector{guide});
  ASSERT_NEAR(all.translation.all_points - alone.translation.all_points, 60.0, 1e-6);
  const FittedCoupling fitted = fit_coupling(scene, stylus(), all, {});
  const double spring = spring_n_per_m(fitted, scene, stylus(), all);
  EXPECT_NEAR(spring + 60.0, fitted.spec.stiffness_cap_n_per_m, 1e-6);
  effects::EffectSpec friction{
      .name = "dry", .kind = effects::find_effect_kind("friction"), .values = {}, .region = {}};
  friction.values = effects::EffectValues(friction.kind->parameters);
  friction.values.at(0)[0] = 0.4;
  EXPECT_EQ(rendering::with_effects(alone, std::vector{friction}), alone)
      << "which the virtual tool does";
}

TEST(Spring, NeverExceedsTheDevicesStiffness) {
  coupling::design::DeviceModel device = arm();
  device.translation.max_stiffness = 60.0;
  const scene::Scene scene = scene_of();
  EXPECT_LE(
      spring_n_per_m(fit(scene, device), scene, device, rendering::spring_of_any_device(kLever)),
      60.0);
}

TEST(Spring, IsLoweredIfRotationIsTheHarderAxis) {
  const scene::Scene scene = scene_of();
  const double lever = 1.0;
  const FittedCoupling fitted = fit(scene, arm(), lever);
  const double spring =
      spring_n_per_m(fitted, scene, arm(), rendering::spring_of_any_device(lever));
  EXPECT_LE(spring * lever * lever, fitted.design.rotation.displayed_stiffness * (1 + 1e-9));
  EXPECT_LT(spring, fitted.design.translation.displayed_stiffness);
}

TEST(Spring, FollowsTheScalesOfTheDevice) {
  scene::Scene scene = scene_of();
  const double plain = spring_n_per_m(fit(scene, stylus()), scene, stylus(),
                                      rendering::spring_of_any_device(kLever));
  scene.device.position_scale = 10.0, scene.device.force_scale = 0.5;
  EXPECT_NEAR(spring_n_per_m(fit(scene, stylus()), scene, stylus(),
                             rendering::spring_of_any_device(kLever)),
              plain / 5.0, 1e-3 * plain);
}

TEST(Spring, IsAbsentForPenaltyContactsOrNoCoupling) {
  const scene::Scene scene = scene_of();
  const rendering::StiffnessBounds contact = {{30.0, 3000.0}, {0.003, 0.3}};
  EXPECT_EQ(spring_n_per_m(fit_coupling(scene, stylus(), contact, {}), scene, stylus(), contact),
            0.0);
  coupling::design::DeviceModel light = stylus();
  light.translation.inertia_min = light.translation.inertia_max = 1e-5;
  light.translation.damping = 0.0;
  const FittedCoupling none = fit(scene, light);
  ASSERT_NE(sentence_of(none.refusal), "");
  EXPECT_EQ(spring_n_per_m(none, scene, light, rendering::spring_of_any_device(kLever)), 0.0);
}

TEST(Spring, OfAManualCouplingIsItsCap) {
  scene::Scene scene = scene_of();
  scene.design.reset();
  scene.coupling.stiffness_cap_n_per_m = 120.0;
  const FittedCoupling fitted = fit(scene, stylus());
  ASSERT_EQ(sentence_of(fitted.refusal), "");
  EXPECT_EQ(spring_n_per_m(fitted, scene, stylus(), rendering::spring_of_any_device(kLever)),
            120.0);
  scene.coupling.stiffness_cap_n_per_m = 5000.0, scene.coupling.kind = "direct";
  const std::string why = sentence_of(fit(scene, stylus()).refusal);
  EXPECT_NE(why.find("800 N/m"), std::string::npos) << why;
  EXPECT_NE(why.find("coupling.stiffness_cap_n_per_m"), std::string::npos) << why;
}

/// Its row in the table of changes: the plan reports the contact as a spring, and all checks are
/// those of the start.
TEST(DeviceCompatibility, ChecksAVirtualToolByTheSameCode) {
  scene::Scene now = scene_of();
  now.effects = {oil(0.2)};
  const rendering::StiffnessBounds alone = rendering::spring_of_any_device(kLever);
  DeviceCompatibility on;
  on.set_device(stylus());
  on.runs(now, alone, rendering::with_effects(alone, now.effects), demand_of(now));
  ASSERT_EQ(sentence_of(on.refusal()), "");
  EXPECT_EQ(on.spring_n_per_m(), spring_n_per_m(fit(now, stylus()), now, stylus(), alone));
  int accepted = 0, refused = 0;
  for (double damping = 0.1; damping < 100.0; damping *= 1.5) {
    scene::Scene next = now;
    next.effects = {oil(damping)};
    const rendering::StiffnessBounds bounds = rendering::with_effects(alone, next.effects);
    const std::string start =
        sentence_of(fit_coupling(next, stylus(), bounds.translation, bounds.rotation).refusal);
    EXPECT_EQ(sentence_of(on.check(next, alone, effects::at_rest(next.effects))), start) << damping;
    (start.empty() ? accepted : refused)++;
  }
  EXPECT_GT(accepted, 1);
  EXPECT_GT(refused, 3);
  // A reload from the penalty contact of the same file, and another device.
  scene::Scene penalty = now;
  penalty.contact = {.model = "field", .stiffness_n_per_m3 = 1e6};
  const rendering::StiffnessBounds contact = {{30.0, 3000.0}, {0.003, 0.3}};
  on.runs(penalty, contact, rendering::with_effects(contact, now.effects), demand_of(penalty));
  EXPECT_EQ(on.spring_n_per_m(), 0.0);
  EXPECT_GT(on.series_spring().translation, 0.0) << "its spring is in series";
  EXPECT_EQ(sentence_of(on.check(now, alone, effects::at_rest(now.effects))), "");
  on.runs(now, alone, rendering::with_effects(alone, now.effects), demand_of(now));
  EXPECT_EQ(on.series_spring().translation, 0.0) << "a virtual tool has its own";
  const double before = on.spring_n_per_m();
  coupling::design::DeviceModel light = stylus();
  light.translation.inertia_min = 0.02, light.translation.inertia_max = 0.04;
  on.set_device(light);
  on.runs(now, alone, rendering::with_effects(alone, now.effects), demand_of(now));
  EXPECT_LT(on.spring_n_per_m(), before);
  EXPECT_EQ(sentence_of(on.refusal()), sentence_of(fit(now, light).refusal));
}

}  // namespace spring_test
}  // namespace voxtouch::device_fit
