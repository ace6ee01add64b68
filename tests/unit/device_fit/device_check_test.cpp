#include "core/device_fit/device_check.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace voxtouch::device_fit {
namespace {

scene::Scene scene_with(double cutoff_hz = 20) {
  scene::Scene s;
  s.contact.stiffness_n_per_m = 10;
  s.coupling.cutoff_hz = cutoff_hz;
  return s;
}
coupling::design::DeviceModel device_with(double max_stiffness, double period_s,
                                          double max_effort) {
  coupling::design::DeviceModel device;
  device.translation.max_stiffness = max_stiffness, device.translation.max_effort = max_effort,
  device.timing.period_s = period_s;
  return device;
}
coupling::design::DeviceModel phantom() { return device_with(1000, 1e-3, 3.3); }
/// With this delay from the sample to the middle of the period of its force.
coupling::design::DeviceModel late(double mass_kg, double delay_s) {
  coupling::design::DeviceModel device = phantom();
  device.translation.inertia_min = mass_kg;
  device.timing.delay_s = delay_s - 1.5 * device.timing.period_s;
  return device;
}

TEST(DeviceCheck, ComparesTheTotalStiffnessAndNotOnePoint) {
  EXPECT_TRUE(check_device(scene_with(), phantom(), 999).fits());
  const DeviceCheck stiff = check_device(scene_with(), phantom(), 2000);
  ASSERT_EQ(stiff.errors.size(), 1U);
  EXPECT_NE(stiff.errors[0].find("2000 N/m"), std::string::npos) << stiff.errors[0];
  EXPECT_NE(stiff.errors[0].find("contact.stiffness_n_per_m"), std::string::npos)
      << stiff.errors[0];
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

TEST(DeviceCheck, SumsEffectStiffnessAndNamesTheStiffest) {
  scene::Scene s = scene_with();
  effects::EffectSpec guide = effect("guide_point", {});
  for (std::size_t n = 0; n < guide.kind->parameters.size(); ++n) {
    if (guide.kind->parameters[n].name == "stiffness_n_per_m")
      guide.values.at(n)[0] = 3000;
    if (guide.kind->parameters[n].name == "limit_n")
      guide.values.at(n)[0] = 2;
  }
  s.effects = {guide};
  EXPECT_DOUBLE_EQ(least_stiffness_n_per_m(s), 10 + 3000);
  const DeviceCheck stiff = check_device(s, phantom(), least_stiffness_n_per_m(s));
  ASSERT_EQ(stiff.errors.size(), 1U);
  EXPECT_NE(stiff.errors[0].find("'guide_point' (a.yaml:7:5) (3000 N/m)"), std::string::npos)
      << stiff.errors[0];
}

TEST(DeviceCheck, UsesOnlyTheGripOfABody) {
  scene::Scene s = scene_with();
  s.effects = {effect("body", {0.1})};
  EXPECT_DOUBLE_EQ(least_stiffness_n_per_m(s), 200);
}

TEST(DeviceCheck, RefusesDampingThatComesTooLateForTheDevice) {
  scene::Scene s = scene_with(80);
  const coupling::design::DeviceModel device = late(0.1, 0.002);
  const double limit = 0.25 * 3.14159265358979 * 0.1 / (coupling::lag_s(s.coupling) + 0.002);
  s.effects = {effect("viscosity", {0.99 * limit})};
  EXPECT_EQ(effects_damp_too_much(demand_of(s), s.device, s.coupling, device), "");
  s.effects = {effect("viscosity", {0.6 * limit}), effect("viscosity", {0.5 * limit})};
  const std::string why = effects_damp_too_much(demand_of(s), s.device, s.coupling, device);
  EXPECT_EQ(why.find("a.yaml:7:5:"), 0U) << why;
  s.device.force_scale = 0.5;
  EXPECT_EQ(effects_damp_too_much(demand_of(s), s.device, s.coupling, device), "")
      << "the hand feels half of it";
}

TEST(DeviceCheck, RefusesLateRotationDampingOnTorqueDevices) {
  scene::Scene s = scene_with(80);
  coupling::design::DeviceModel device = late(0.1, 0.002);
  device.gives_torque = true, device.rotation.inertia_min = 1e-3;
  const double limit = 0.25 * 3.14159265358979 * 1e-3 / (coupling::lag_s(s.coupling) + 0.002);
  s.effects = {effect("viscosity", {0.0, 0.99 * limit})};
  EXPECT_EQ(effects_damp_too_much(demand_of(s), s.device, s.coupling, device), "");
  s.effects = {effect("viscosity", {0.0, 0.6 * limit}), effect("viscosity", {0.0, 0.5 * limit})};
  const std::string why = effects_damp_too_much(demand_of(s), s.device, s.coupling, device);
  EXPECT_EQ(why.find("a.yaml:7:5:"), 0U) << why;
  EXPECT_NE(why.find("released device of 0.001 kg m^2"), std::string::npos) << why;
  s.device.position_scale = 2.0;
  EXPECT_EQ(effects_damp_too_much(demand_of(s), s.device, s.coupling, device), "")
      << "the hand feels half of it";
  s.device.position_scale = 1.0, device.gives_torque = false;
  EXPECT_EQ(effects_damp_too_much(demand_of(s), s.device, s.coupling, device), "")
      << "nothing of it is displayed";
}

TEST(DeviceCheck, CountsTheScalesAndTheCoupling) {
  scene::Scene s = scene_with();
  s.device.position_scale = 4, s.device.force_scale = 0.5;
  EXPECT_DOUBLE_EQ(stiffness_at_hand_n_per_m(s.coupling, s.device, 600), 1200);
  EXPECT_FALSE(check_device(s, phantom(), 600).fits());
  s.coupling.gain = 0.5;
  EXPECT_TRUE(check_device(s, phantom(), 600).fits());
  s.coupling.kind = "spring_damper", s.coupling.stiffness_n_per_m = 600;
  EXPECT_DOUBLE_EQ(stiffness_at_hand_n_per_m(s.coupling, s.device, 600), 600);
  s.coupling.kind = "direct";
  EXPECT_DOUBLE_EQ(stiffness_at_hand_n_per_m(s.coupling, s.device, 600), 1200);
}

TEST(DeviceCheck, CountsTheCouplingsCap) {
  scene::Scene s = scene_with();
  s.coupling.stiffness_cap_n_per_m = 900;
  EXPECT_DOUBLE_EQ(stiffness_at_hand_n_per_m(s.coupling, s.device, 5000), 900);
  EXPECT_DOUBLE_EQ(stiffness_at_hand_n_per_m(s.coupling, s.device, 500), 500);
  EXPECT_TRUE(check_device(s, phantom(), 5000).fits());
  s.coupling.stiffness_cap_n_per_m = 1100;
  EXPECT_FALSE(check_device(s, phantom(), 5000).fits());
  EXPECT_FALSE(check_device(s, phantom(), std::numeric_limits<double>::quiet_NaN()).fits());
}

TEST(DeviceCheck, ChecksTheFilterAgainstTheDevicesPeriod) {
  coupling::design::DeviceModel slow = phantom();
  slow.timing.period_s = 5e-3;
  EXPECT_TRUE(check_device(scene_with(20), phantom(), 1).warnings.empty());
  EXPECT_EQ(check_device(scene_with(20), slow, 1).warnings.size(), 1U);
  EXPECT_FALSE(check_device(scene_with(150), slow, 1).fits());
}

TEST(DeviceCheck, RefusesNanAndInfinity) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -1.0})
    EXPECT_FALSE(check_device(scene_with(), phantom(), bad).fits());
  for (const double bad : {nan, 0.0, -1.0})
    EXPECT_FALSE(check_device(scene_with(), device_with(bad, 1e-3, 3.3), 10).fits());
  for (const double bad : {nan, 0.0, -1.0, inf})
    EXPECT_FALSE(check_device(scene_with(), device_with(1000, bad, 3.3), 10).fits());
  EXPECT_FALSE(check_device(scene_with(), device_with(1000, 1e-3, nan), 10).fits());
  EXPECT_TRUE(check_device(scene_with(), device_with(inf, 1e-3, inf), 1e6).fits())
      << "infinity is no limit";
}

TEST(DeviceCheck, NamesAnEffectWithUndisplayableTorque) {
  scene::Scene s = scene_with();
  effects::EffectSpec oil{
      .name = "oil", .kind = effects::find_effect_kind("viscosity"), .values = {}, .region = {}};
  oil.values = effects::EffectValues(oil.kind->parameters);
  oil.values.at(0)[0] = 1.0;
  s.effects = {oil};
  EXPECT_EQ(torque_not_displayed(demand_of(s), false), "");
  s.effects[0].values.at(1)[0] = 0.1;
  EXPECT_NE(torque_not_displayed(demand_of(s), false).find("'oil'"), std::string::npos);
  EXPECT_EQ(torque_not_displayed(demand_of(s), true), "");
}

}  // namespace
}  // namespace voxtouch::device_fit
