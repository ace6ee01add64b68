// Requirements of an effect that follows an external program, compared with the device's limits: at
// the start and at each change.
#include <gtest/gtest.h>

#include "core/device_fit/device_compatibility.hpp"
#include "core/scene/scene_file.hpp"
#include "nodes/design_text/design_text.hpp"

namespace voxtouch::device_fit {

using design_text::sentence_of;
namespace external_demand_test {

constexpr rendering::StiffnessBounds kContact = {{30.0, 3000.0}, {0.003, 0.3}};
enum : std::size_t { kForce = 1, kTorque = 2 };

coupling::design::DeviceModel device(double max_force_n, double max_torque_nm = 0.0) {
  coupling::design::DeviceModel model;
  model.name = "stylus";
  model.translation = {.inertia_min = 0.1,
                       .inertia_max = 0.2,
                       .damping = 2.0,
                       .resolution = 3e-5,
                       .max_effort = max_force_n,
                       .max_stiffness = 800.0};
  model.timing.delay_s = 1e-3;
  model.gives_torque = max_torque_nm > 0.0;
  if (model.gives_torque)
    model.rotation = {.inertia_min = 0.01,
                      .inertia_max = 0.02,
                      .damping = 0.05,
                      .resolution = 1e-5,
                      .max_effort = max_torque_nm,
                      .max_stiffness = 50.0};
  return model;
}

scene::Scene scene_with(double force_n, double torque_nm = 0.0) {
  scene::Scene scene = scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
  effects::EffectSpec spec{.name = "external",
                           .kind = effects::find_effect_kind("external"),
                           .values = {},
                           .region = {}};
  spec.values = effects::EffectValues(spec.kind->parameters);
  spec.values.at(kForce)[0] = force_n, spec.values.at(kTorque)[0] = torque_nm;
  spec.place = "a.yaml:7:5";
  scene.effects = {spec};
  return scene;
}

std::string at_start(const scene::Scene& scene, const coupling::design::DeviceModel& device) {
  const rendering::StiffnessBounds bounds = rendering::with_effects(kContact, scene.effects);
  return sentence_of(fit_coupling(scene, device, bounds.translation, bounds.rotation).refusal);
}

void says(const std::string& why, std::initializer_list<const char*> words) {
  for (const char* word : words)
    EXPECT_NE(why.find(word), std::string::npos) << why << "\nshould say: " << word;
}

TEST(ExternalDemand, BeyondTheDevicesForceIsRefusedAtStart) {
  EXPECT_EQ(at_start(scene_with(2.0), device(8.5)), "");
  EXPECT_EQ(at_start(scene_with(8.5), device(8.5)), "");
  says(at_start(scene_with(2.0), device(1.5)),
       {"a.yaml:7:5", "'external'", "2 N", "1.5 N", "max_force_n"});
  EXPECT_EQ(at_start(scene_with(2.0, 0.05), device(8.5, 0.5)), "");
  says(at_start(scene_with(2.0, 0.05), device(8.5, 0.04)),
       {"a.yaml:7:5", "0.05 Nm", "0.04 Nm", "max_torque_nm"});
  says(at_start(scene_with(2.0, 0.05), device(8.5)), {"does not return"});
  scene::Scene scaled = scene_with(2.0);
  scaled.device.force_scale = 5.0;
  says(at_start(scaled, device(8.5)), {"10 N at the hand", "8.5 N"});
  scene::Scene off = scene_with(2.0);
  off.effects[0].on = false, off.effects[0].gain = 0.1;
  EXPECT_NE(at_start(off, device(1.5)), "") << "it counts at full gain, also while it is off";
}

TEST(ExternalDemand, IsRefusedAtEveryLaterChangeByTheSameSentence) {
  const scene::Scene now = scene_with(1.0);
  const rendering::StiffnessBounds bounds = rendering::with_effects(kContact, now.effects);
  DeviceCompatibility on;
  on.set_device(device(3.0));
  on.runs(now, bounds, bounds, demand_of(now));
  ASSERT_EQ(sentence_of(on.refusal()), "");
  for (const double force : {0.5, 2.9, 3.0, 3.1, 50.0}) {
    const scene::Scene next = scene_with(force);
    EXPECT_EQ(sentence_of(on.check(next, kContact, effects::at_rest(next.effects))),
              at_start(next, device(3.0)))
        << force;
    EXPECT_EQ(at_start(next, device(3.0)).empty(), force <= 3.0) << force;
  }
  on.set_device(device(0.5));  // described anew
  on.runs(now, bounds, bounds, demand_of(now));
  EXPECT_NE(sentence_of(on.refusal()), "");
  const scene::Scene less = scene_with(0.7), more = scene_with(1.1);
  EXPECT_EQ(sentence_of(on.check(less, kContact, effects::at_rest(less.effects))), "")
      << "it demands no more than what runs, which commands nothing";
  EXPECT_NE(sentence_of(on.check(more, kContact, effects::at_rest(more.effects))), "");
}

TEST(ExternalDemand, OfATransitionIsTheLargerOfBoth) {
  EXPECT_EQ(larger_of(demand_of(scene_with(2.0)), demand_of(scene_with(1.0))).external.force_n,
            2.0);
  EXPECT_EQ(larger_of(demand_of(scene_with(1.0)), demand_of(scene_with(2.0))).external.force_n,
            2.0);
  effects::EffectReach reach(scene_with(4.0).effects[0]);
  reach.widen(scene_with(1.0).effects[0]);
  EXPECT_EQ(demand_of(scene_with(1.0), std::vector{reach}).external.force_n, 4.0)
      << "on its way down";
  EXPECT_EQ(demand_of(scene_with(1.0)).external.name, "external");
}

}  // namespace external_demand_test
}  // namespace voxtouch::device_fit
