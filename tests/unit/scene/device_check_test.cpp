#include "core/scene/device_check.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace voxtouch {
namespace {

Scene scene_with(double cutoff_hz = 20) {
  Scene s;
  s.contact.stiffness_n_per_m = 10;
  s.coupling.cutoff_hz = cutoff_hz;
  return s;
}
DeviceFacts phantom() { return {1000, 1e-3, 3.3}; }

TEST(DeviceCheck, ComparesTheTotalStiffnessAndNotOnePoint) {
  EXPECT_TRUE(check_device(scene_with(), phantom(), 999).fits());
  const DeviceCheck stiff = check_device(scene_with(), phantom(), 2000);
  ASSERT_EQ(stiff.errors.size(), 1U);
  EXPECT_NE(stiff.errors[0].find("2000 N/m at the hand"), std::string::npos) << stiff.errors[0];
  EXPECT_NE(stiff.errors[0].find("below 5,"), std::string::npos) << "the stiffness per point that would fit";
}

TEST(DeviceCheck, CountsTheScalesAndTheCoupling) {
  Scene s = scene_with();
  s.device.position_scale = 4, s.device.force_scale = 0.5;
  EXPECT_DOUBLE_EQ(stiffness_at_hand_n_per_m(s, 600), 1200);
  EXPECT_FALSE(check_device(s, phantom(), 600).fits());
  s.coupling.gain = 0.5;
  EXPECT_TRUE(check_device(s, phantom(), 600).fits());
  s.coupling.kind = "spring_damper", s.coupling.stiffness_n_per_m = 600;
  EXPECT_DOUBLE_EQ(stiffness_at_hand_n_per_m(s, 600), 600);
  s.coupling.kind = "direct";
  EXPECT_DOUBLE_EQ(stiffness_at_hand_n_per_m(s, 600), 1200);
}

TEST(DeviceCheck, CountsTheCouplingsCap) {
  Scene s = scene_with();
  s.coupling.stiffness_cap_n_per_m = 900;
  EXPECT_DOUBLE_EQ(stiffness_at_hand_n_per_m(s, 5000), 900);
  EXPECT_DOUBLE_EQ(stiffness_at_hand_n_per_m(s, 500), 500);
  EXPECT_TRUE(check_device(s, phantom(), 5000).fits());
  s.coupling.stiffness_cap_n_per_m = 1100;
  EXPECT_FALSE(check_device(s, phantom(), 5000).fits());
  EXPECT_FALSE(check_device(s, phantom(), std::numeric_limits<double>::quiet_NaN()).fits());
}

TEST(DeviceCheck, JudgesTheFilterForTheDevicesOwnPeriod) {
  DeviceFacts slow = phantom();
  slow.sample_time_s = 5e-3;
  EXPECT_TRUE(check_device(scene_with(20), phantom(), 1).warnings.empty());
  EXPECT_EQ(check_device(scene_with(20), slow, 1).warnings.size(), 1U);
  EXPECT_FALSE(check_device(scene_with(150), slow, 1).fits());
}

TEST(DeviceCheck, LetsNothingPassThatIsNoNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -1.0}) EXPECT_FALSE(check_device(scene_with(), phantom(), bad).fits());
  for (const double bad : {nan, 0.0, -1.0}) EXPECT_FALSE(check_device(scene_with(), {bad, 1e-3, 3.3}, 10).fits());
  for (const double bad : {nan, 0.0, -1.0, inf}) EXPECT_FALSE(check_device(scene_with(), {1000, bad, 3.3}, 10).fits());
  EXPECT_FALSE(check_device(scene_with(), {1000, 1e-3, nan}, 10).fits());
  EXPECT_TRUE(check_device(scene_with(), {inf, 1e-3, inf}, 1e6).fits()) << "infinity is no limit";
}

TEST(DeviceCheck, NamesEachEffectWhoseTorqueADeviceWithoutTorqueCannotShow) {
  Scene s = scene_with();
  EffectSpec oil{.name = "oil", .kind = find_effect_kind("viscosity"), .values = {}, .region = {}};
  oil.values = EffectValues(oil.kind->parameters);
  oil.values.at(0)[0] = 1.0;
  s.effects = {oil};
  EXPECT_TRUE(effects_not_shown(s, false).empty());
  s.effects[0].values.at(1)[0] = 0.1;
  ASSERT_EQ(effects_not_shown(s, false).size(), 1U);
  EXPECT_NE(effects_not_shown(s, false)[0].find("'oil' gives torque"), std::string::npos);
  EXPECT_TRUE(effects_not_shown(s, true).empty());
}

}  // namespace
}  // namespace voxtouch
