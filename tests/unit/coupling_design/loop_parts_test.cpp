#include "core/coupling/design/loop_parts.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace voxtouch::coupling::design {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                 kInfinity = std::numeric_limits<double>::infinity();

DeviceModel good_device() {
  DeviceModel d;
  d.name = "stylus";
  d.translation = {.inertia_min = 0.045,
                   .inertia_max = 0.075,
                   .damping = 0.005,
                   .coulomb_friction = 0.04,
                   .resolution = 3e-5,
                   .max_effort = 8.5,
                   .max_stiffness = 3500.0,
                   .effort_bandwidth_hz = kInfinity};
  d.rotation = d.translation;
  d.gives_torque = true;
  return d;
}

HandRange good_hand() {
  HandRange h;
  h.mass_min = 0.02, h.mass_max = 0.2, h.damping_min = 0.5, h.damping_max = 8.0,
  h.stiffness_min = 20.0, h.stiffness_max = 800.0;
  return h;
}

struct DeviceFault {
  const char* begins;  ///< of the expected sentence
  std::function<void(DeviceModel&)> plant;
};

TEST(LoopParts, AcceptWhatCanBeDesignedFor) {
  EXPECT_TRUE(check(good_device()).empty());
  EXPECT_TRUE(check(good_hand()).empty());
  EXPECT_TRUE(check(HandRange{}).empty()) << "released only";
  DeviceModel undamped = good_device();
  undamped.translation.damping = 0.0;
  EXPECT_TRUE(check(undamped).empty()) << "it can be designed for: injected damping may save it";
}

TEST(LoopParts, NameFieldValueAndRuleOfEveryImpossibleNumber) {
  const DeviceFault faults[] = {
      {"translation.inertia_min is 0;", [](auto& d) { d.translation.inertia_min = 0.0; }},
      {"translation.inertia_min is nan;", [](auto& d) { d.translation.inertia_min = kNan; }},
      {"translation.inertia_max is inf;", [](auto& d) { d.translation.inertia_max = kInfinity; }},
      {"translation.inertia_max is 0.03;", [](auto& d) { d.translation.inertia_max = 0.03; }},
      {"translation.damping is -1;", [](auto& d) { d.translation.damping = -1.0; }},
      {"translation.damping is nan;", [](auto& d) { d.translation.damping = kNan; }},
      {"translation.coulomb_friction is -0.1;",
       [](auto& d) { d.translation.coulomb_friction = -0.1; }},
      {"translation.resolution is -1e-06;", [](auto& d) { d.translation.resolution = -1e-6; }},
      {"translation.max_effort is 0;", [](auto& d) { d.translation.max_effort = 0.0; }},
      {"translation.max_stiffness is nan;", [](auto& d) { d.translation.max_stiffness = kNan; }},
      {"translation.effort_bandwidth_hz is 0;",
       [](auto& d) { d.translation.effort_bandwidth_hz = 0.0; }},
      {"translation.inertia_min is 1e-100;", [](auto& d) { d.translation.inertia_min = 1e-100; }},
      {"translation.damping is 1e+100;", [](auto& d) { d.translation.damping = 1e100; }},
      {"translation.damping is 1e-100;", [](auto& d) { d.translation.damping = 1e-100; }},
      {"translation.effort_bandwidth_hz is 1e-100;",
       [](auto& d) { d.translation.effort_bandwidth_hz = 1e-100; }},
      {"rotation.inertia_min is -1;", [](auto& d) { d.rotation.inertia_min = -1.0; }},
      {"timing.period_s is 0;", [](auto& d) { d.timing.period_s = 0.0; }},
      {"timing.delay_s is -0.001;", [](auto& d) { d.timing.delay_s = -0.001; }},
      {"timing.delay_s is 0.3;", [](auto& d) { d.timing.delay_s = 0.3; }},
      {"timing.jitter is nan;", [](auto& d) { d.timing.jitter = kNan; }},
      {"timing.consecutive_losses is -1;", [](auto& d) { d.timing.consecutive_losses = -1; }},
  };
  for (const DeviceFault& fault : faults) {
    DeviceModel device = good_device();
    fault.plant(device);
    const auto found = check(device);
    ASSERT_EQ(found.size(), 1u) << fault.begins;
    EXPECT_EQ(found[0].substr(0, std::string(fault.begins).size()), fault.begins);
    EXPECT_EQ(found[0].back(), '.');
  }
}

TEST(LoopParts, SkipTheRotationOfADeviceWithoutTorque) {
  DeviceModel device = good_device();
  device.rotation = {};
  EXPECT_FALSE(check(device).empty());
  device.gives_torque = false;
  EXPECT_TRUE(check(device).empty());
}

TEST(LoopParts, NameEveryImpossibleNumberOfAHand) {
  const std::pair<const char*, std::function<void(HandRange&)>> faults[] = {
      {"mass_min is -1;", [](auto& h) { h.mass_min = -1.0; }},
      {"mass_max is 0.01;", [](auto& h) { h.mass_max = 0.01; }},
      {"damping_min is nan;", [](auto& h) { h.damping_min = kNan; }},
      {"damping_max is 0.1;", [](auto& h) { h.damping_max = 0.1; }},
      {"stiffness_min is 900;", [](auto& h) { h.stiffness_min = 900.0; }},
      {"stiffness_max is inf;", [](auto& h) { h.stiffness_max = kInfinity; }},
  };
  for (const auto& [begins, plant] : faults) {
    HandRange hand = good_hand();
    plant(hand);
    const auto found = check(hand);
    ASSERT_EQ(found.size(), 1u) << begins;
    if (std::string(begins).find("stiffness_min is 900") == std::string::npos) {
      EXPECT_EQ(found[0].substr(0, std::string(begins).size()), begins);
    } else {  // the pair is wrong: reported for the larger one
      EXPECT_TRUE(found[0].starts_with("stiffness_max is 800;") &&
                  found[0].contains("stiffness_min") && found[0].contains("900"))
          << found[0];
    }
    hand.any_passive = true;
    EXPECT_TRUE(check(hand).empty()) << "not used";
  }
}

}  // namespace
}  // namespace voxtouch::coupling::design
