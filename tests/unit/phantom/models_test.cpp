// Known properties of a model, and the description derived from them.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "devices/force_guard.hpp"
#include "devices/phantom/phantom_models.hpp"
#include "devices/sim/parameters.hpp"

namespace voxtouch::phantom {
namespace {

TEST(PhantomModels, TheLongestPrefixCountsAndCapitalsDoNot) {
  EXPECT_EQ(phantom_figures("PHANTOM Premium 1.5").prefix, "PHANTOM Premium 1.5");
  EXPECT_EQ(phantom_figures("PHANToM premium 1.5 6DOF").prefix, "PHANTOM Premium 1.5");
  EXPECT_EQ(phantom_figures("PHANTOM Premium 1.5 High Force/6DOF").prefix,
            "PHANTOM Premium 1.5 High Force");
  EXPECT_EQ(phantom_figures("Touch X").prefix, "Touch");
  EXPECT_EQ(phantom_figures("PHANTOM").prefix, "");
  EXPECT_EQ(phantom_figures("").prefix, "");
}

TEST(PhantomModels, DeviceFactsWinExceptStructuralStiffness) {
  PhantomFacts facts;
  facts.model = "PHANTOM Premium 1.5";
  facts.rate_hz = 1000;
  facts.max_force_n = 7.0;
  facts.max_stiffness_n_per_m = 3500.0;
  const DeviceDescription d = describe_phantom(facts);
  EXPECT_EQ(d.max_force_n, 7.0);
  EXPECT_EQ(d.max_stiffness_n_per_m, 800.0);
  facts.max_stiffness_n_per_m = 500.0;
  EXPECT_EQ(describe_phantom(facts).max_stiffness_n_per_m, 500.0);
  EXPECT_EQ(d.delay_s, 1e-3);
  EXPECT_EQ(d.max_torque_nm, 0.0);
  EXPECT_EQ(d.model, "PHANTOM Premium 1.5");
}

TEST(PhantomModels, ImplausibleFiguresAreIgnored) {
  PhantomFacts none, absurd;
  none.model = absurd.model = "Touch";
  none.rate_hz = absurd.rate_hz = 1000;
  none.output_dof = absurd.output_dof = 6;
  const DeviceDescription d = describe_phantom(none);
  for (const double x :
       {-1.0, 0.0, 5e-324, 1e-4, 1e12, 1e307, std::numeric_limits<double>::infinity(),
        std::numeric_limits<double>::quiet_NaN()}) {
    absurd.max_force_n = absurd.continuous_force_n = absurd.max_torque_nm =
        absurd.max_stiffness_n_per_m = absurd.max_impulse_n_per_s = x;
    const DeviceDescription a = describe_phantom(absurd);
    EXPECT_EQ(a.max_force_n, d.max_force_n) << x;
    EXPECT_EQ(a.max_torque_nm, d.max_torque_nm) << x;
    EXPECT_EQ(a.max_stiffness_n_per_m, d.max_stiffness_n_per_m) << x;
    EXPECT_EQ(a.max_force_rate_n_per_s, d.max_force_rate_n_per_s) << x;
    EXPECT_EQ(continuous_force_n(absurd), continuous_force_n(none)) << x;
    EXPECT_EQ(validate(a), "") << x;
  }
}

TEST(PhantomModels, PremiumMatchesTheSimulatedPhantom) {
  PhantomFacts facts;
  facts.model = "PHANTOM Premium 1.5";
  facts.rate_hz = 1000;
  const DeviceDescription d = describe_phantom(facts), s = sim::sim_phantom().description;
  EXPECT_EQ(d.max_force_n, s.max_force_n);
  EXPECT_EQ(d.max_stiffness_n_per_m, s.max_stiffness_n_per_m);
  EXPECT_EQ(d.mass_min_kg, s.mass_min_kg);
  EXPECT_EQ(d.mass_max_kg, s.mass_max_kg);
  EXPECT_EQ(d.damping_ns_per_m, s.damping_ns_per_m);
  EXPECT_EQ(d.coulomb_friction_n, s.coulomb_friction_n);
  EXPECT_EQ(d.position_resolution_m, s.position_resolution_m);
  EXPECT_EQ(d.max_force_rate_n_per_s, s.max_force_rate_n_per_s);
  EXPECT_EQ(d.delay_s, s.delay_s);
}

TEST(PhantomModels, EveryDescriptionFitsTheGuard) {
  for (const char* model :
       {"PHANTOM Premium 1.0", "PHANTOM Premium 1.5", "PHANTOM Premium 1.5 High Force",
        "PHANTOM Premium 3.0 6DOF", "PHANTOM Desktop", "PHANTOM Omni", "Touch", "nothing known"})
    for (const int dof : {3, 6}) {
      PhantomFacts facts;
      facts.model = model;
      facts.output_dof = dof;
      facts.max_torque_nm = 0.188;
      const DeviceDescription d = describe_phantom(facts);
      EXPECT_NO_THROW(devices::guard_config(d).validate()) << model;
      EXPECT_EQ(d.max_torque_nm > 0.0, dof == 6);
      EXPECT_LE(continuous_force_n(facts), d.max_force_n);
      EXPECT_GT(d.mass_max_kg, d.mass_min_kg);
    }
}

TEST(PhantomModels, InvalidNumbersAreIgnored) {
  PhantomFacts facts;
  facts.model = "PHANTOM Omni";
  facts.max_force_n = std::numeric_limits<double>::quiet_NaN();
  facts.continuous_force_n = -1.0;
  facts.max_stiffness_n_per_m = std::numeric_limits<double>::infinity();
  const DeviceDescription d = describe_phantom(facts);
  EXPECT_EQ(d.max_force_n, 3.3);
  EXPECT_EQ(d.max_stiffness_n_per_m, 700.0);
  EXPECT_EQ(continuous_force_n(facts), 0.88);
}

TEST(PhantomModels, RatesAreLimitedToServoRates) {
  EXPECT_EQ(servo_rate_hz(997.0), 1000.0);
  EXPECT_EQ(servo_rate_hz(1603.0), 1600.0);
  EXPECT_EQ(servo_rate_hz(495.0), 500.0);
  EXPECT_EQ(servo_rate_hz(2004.0), 2000.0);
  EXPECT_EQ(servo_rate_hz(0.0), 1000.0);
  EXPECT_EQ(servo_rate_hz(std::numeric_limits<double>::quiet_NaN()), 1000.0);
  EXPECT_EQ(servo_rate_hz(1e6), 1000.0);
}

}  // namespace
}  // namespace voxtouch::phantom
