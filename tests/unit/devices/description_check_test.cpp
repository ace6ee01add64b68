#include "core/types/device_description.hpp"

#include <gtest/gtest.h>

#include "devices/registry.hpp"

namespace voxtouch::devices {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Description, OfEveryKnownDeviceIsPossible) {
  for (const std::string& name : device_names())
    EXPECT_EQ(validate(describe_device(name)), "") << name;
}

TEST(Description, IsRefusedForEachInvalidNumber) {
  double DeviceDescription::*const numbers[] = {&DeviceDescription::rate_hz,
                                                &DeviceDescription::max_force_n,
                                                &DeviceDescription::max_torque_nm,
                                                &DeviceDescription::max_force_rate_n_per_s,
                                                &DeviceDescription::max_torque_rate_nm_per_s,
                                                &DeviceDescription::max_stiffness_n_per_m,
                                                &DeviceDescription::mass_min_kg,
                                                &DeviceDescription::mass_max_kg,
                                                &DeviceDescription::damping_ns_per_m,
                                                &DeviceDescription::coulomb_friction_n,
                                                &DeviceDescription::position_resolution_m,
                                                &DeviceDescription::delay_s,
                                                &DeviceDescription::force_bandwidth_hz,
                                                &DeviceDescription::inertia_min_kg_m2,
                                                &DeviceDescription::inertia_max_kg_m2,
                                                &DeviceDescription::damping_nms_per_rad,
                                                &DeviceDescription::coulomb_friction_nm,
                                                &DeviceDescription::orientation_resolution_rad,
                                                &DeviceDescription::max_stiffness_nm_per_rad,
                                                &DeviceDescription::jitter};
  const DeviceDescription good = describe_device("sim-lwr");
  for (const auto number : numbers)
    for (const double impossible : {kNan, -1.0, -kInfinity}) {
      DeviceDescription d = good;
      d.*number = impossible;
      EXPECT_NE(validate(d), "") << impossible;
    }
  DeviceDescription swapped = good;
  std::swap(swapped.mass_min_kg, swapped.mass_max_kg);
  EXPECT_NE(validate(swapped).find("mass_max_kg is 3"), std::string::npos) << validate(swapped);
  DeviceDescription gripped = good;
  gripped.grip = "teeth";
  EXPECT_NE(validate(gripped), "");
}

}  // namespace
}  // namespace voxtouch::devices
