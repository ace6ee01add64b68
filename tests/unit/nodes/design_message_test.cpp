#include "nodes/coupling/design_message.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace voxtouch::coupling_node {
namespace {

/// Every field has a different value, none its default.
Adoption distinct() {
  Adoption use{7, 812, true, {}, 0.0013};
  auto& [kind, cutoff, ratio, gain, c, r, cap, cap_rotation, injected, injected_rotation, filter,
         window, slow, band, fraction, free_n] =
      use.coupling.spec;  // a field more does not compile: it has to go with the message
  double next = 0.1;
  for (double* number : {&cutoff, &ratio, &gain, &c, &r, &cap, &cap_rotation, &injected,
                         &injected_rotation, &filter, &slow, &band, &fraction, &free_n})
    *number = next += 1.0 / 3.0;
  kind = "spring_damper", window = 3;
  auto& [force, torque, resolution, damping, friction, delay, lag] = use.coupling.limits;
  force = next + 1.0 / 7.0, torque = std::numeric_limits<double>::infinity();
  resolution = next + 2.0 / 7.0, damping = next + 3.0 / 7.0, friction = next + 4.0 / 7.0;
  delay = next + 5.0 / 7.0, lag = next + 6.0 / 7.0;
  use.coupling.runs = true;
  return use;
}

Adoption through_the_message(const Adoption& use) {
  msg::CouplingDesign message{};
  write_coupling(use, message);
  return adoption_of(message);
}

TEST(DesignMessage, CarriesAllCouplingParameters) {
  const Adoption use = distinct(), back = through_the_message(use);
  EXPECT_EQ(back.session, use.session);
  EXPECT_EQ(back.from_sample, use.from_sample);
  EXPECT_EQ(back.sample_time_s, use.sample_time_s);
  EXPECT_EQ(back.coupling.spec, use.coupling.spec);
  EXPECT_EQ(back.coupling.limits.max_force_n, use.coupling.limits.max_force_n);
  EXPECT_EQ(back.coupling.limits.max_torque_nm, use.coupling.limits.max_torque_nm);
  EXPECT_EQ(back.coupling.limits.resolution_m, use.coupling.limits.resolution_m);
  EXPECT_EQ(back.coupling.limits.damping_ns_per_m, use.coupling.limits.damping_ns_per_m);
  EXPECT_EQ(back.coupling.limits.coulomb_friction_n, use.coupling.limits.coulomb_friction_n);
  EXPECT_EQ(back.coupling.limits.delay_s, use.coupling.limits.delay_s);
  EXPECT_EQ(back.coupling.limits.force_lag_s, use.coupling.limits.force_lag_s);
  EXPECT_TRUE(back.starts_at_rest && back.coupling.runs);
  EXPECT_TRUE(differences(use.coupling, back.coupling).empty());
}

TEST(DesignMessage, NamesEachNumberThatDiffersByABit) {
  const AdoptedCoupling recorded = distinct().coupling;
  AdoptedCoupling now = recorded;
  now.spec.injected_damping_nms_per_rad =
      std::nextafter(now.spec.injected_damping_nms_per_rad, 9.0);
  ASSERT_EQ(differences(recorded, now).size(), 1U);
  EXPECT_TRUE(differences(recorded, now)[0].starts_with("injected_damping_nms_per_rad "));
  EXPECT_EQ(differences(AdoptedCoupling{}, recorded).size(), 22U)
      << "14 numbers, kind, window, one limit (the other is infinite in both) and five figures of "
         "the device";
}

}  // namespace
}  // namespace voxtouch::coupling_node
