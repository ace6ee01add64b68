// The driver's figures and those of the device file are one source in two places: this holds them
// together.
#include <gtest/gtest.h>

#include "core/scene/device_file.hpp"
#include "devices/fr3/fr3_driver.hpp"

namespace voxtouch::fr3 {
namespace description_test {

TEST(Fr3Description, IsThatOfTheDeviceFile) {
  const DeviceDescription file = scene::load_device_file(VOXTOUCH_DEPLOY "/devices/fr3.yaml")
                                     .description,
                          d = describe_fr3();
  EXPECT_EQ(d.model, file.model);
  EXPECT_EQ(d.rate_hz, file.rate_hz);
  EXPECT_EQ(d.max_force_n, file.max_force_n);
  EXPECT_EQ(d.max_torque_nm, file.max_torque_nm);
  EXPECT_DOUBLE_EQ(d.max_force_rate_n_per_s, file.max_force_rate_n_per_s);
  EXPECT_DOUBLE_EQ(d.max_torque_rate_nm_per_s, file.max_torque_rate_nm_per_s);
  EXPECT_EQ(d.max_stiffness_n_per_m, file.max_stiffness_n_per_m);
  EXPECT_EQ(d.mass_min_kg, file.mass_min_kg);
  EXPECT_EQ(d.mass_max_kg, file.mass_max_kg);
  EXPECT_EQ(d.damping_ns_per_m, file.damping_ns_per_m);
  EXPECT_EQ(d.coulomb_friction_n, file.coulomb_friction_n);
  EXPECT_EQ(d.position_resolution_m, file.position_resolution_m);
  EXPECT_EQ(d.delay_s, file.delay_s);
  EXPECT_EQ(d.force_bandwidth_hz, file.force_bandwidth_hz);
  EXPECT_EQ(d.inertia_min_kg_m2, file.inertia_min_kg_m2);
  EXPECT_EQ(d.inertia_max_kg_m2, file.inertia_max_kg_m2);
  EXPECT_EQ(d.damping_nms_per_rad, file.damping_nms_per_rad);
  EXPECT_EQ(d.coulomb_friction_nm, file.coulomb_friction_nm);
  EXPECT_EQ(d.orientation_resolution_rad, file.orientation_resolution_rad);
  EXPECT_EQ(d.max_stiffness_nm_per_rad, file.max_stiffness_nm_per_rad);
  EXPECT_EQ(d.jitter, file.jitter);
  EXPECT_EQ(d.consecutive_losses, file.consecutive_losses);
  EXPECT_EQ(d.grip, file.grip);
  EXPECT_EQ(d.output_dof, file.output_dof);
}

}  // namespace description_test
}  // namespace voxtouch::fr3
