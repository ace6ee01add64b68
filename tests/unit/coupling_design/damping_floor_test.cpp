// How a loop comes to rest, against closed forms; and what floors of the damping ratio cost.
#include "core/coupling/design/damping_floor.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/coupling/design/sampled_loop.hpp"

namespace voxtouch::coupling::design {
namespace {

LoopController direct() {
  LoopController law;
  law.law = LoopController::Law::kDirect;
  return law;
}

/// Sampled so fast that the loop is the continuous one: b / (2 sqrt(m k)).
TEST(SlowestSwing, IsTheDampingRatioOfMassSpringAndDamper) {
  for (const double ratio : {0.02, 0.1, 0.3, 0.7}) {
    const double m = 0.1, k = 400.0, b = 2.0 * ratio * std::sqrt(m * k);
    LoopPlant plant{.mass = m, .damping = b, .period_s = 1e-6};
    EXPECT_NEAR(slowest_damping_ratio(plant, direct(), k), ratio, 1e-3);
    plant.hand_stiffness = 0.5 * k;  // hand and wall share the spring
    EXPECT_NEAR(slowest_damping_ratio(plant, direct(), 0.5 * k), ratio, 1e-3);
  }
}

TEST(SlowestSwing, IsOneWhereNothingSwingsAndNegativeWhereItGrows) {
  LoopPlant plant{.mass = 0.1, .damping = 40.0, .period_s = 1e-5};
  EXPECT_EQ(slowest_damping_ratio(plant, direct(), 400.0), 1.0) << "overdamped";
  plant.damping = 0.1, plant.period_s = 1e-3;
  EXPECT_LT(slowest_damping_ratio(plant, direct(), 2.0 * critical_stiffness(plant, direct()).stiffness), 0.0);
  EXPECT_NEAR(slowest_damping_ratio(plant, direct(), critical_stiffness(plant, direct()).stiffness), 0.0, 1e-6);
}

DesignProblem arm(double mass_max, double contact) {
  DesignProblem p;
  p.device.translation = {.inertia_min = 4.8, .inertia_max = mass_max, .damping = 6, .coulomb_friction = 3, .resolution = 2e-5,
                          .max_effort = 150, .max_stiffness = 5000, .effort_bandwidth_hz = 53};
  p.device.timing.delay_s = 2e-3;
  p.hand.translation = {.mass_min = 0.3, .mass_max = 2, .damping_min = 3, .damping_max = 30, .stiffness_min = 50, .stiffness_max = 600};
  p.contact = {10, contact};
  p.goals.free_cap = true;
  return p;
}

TEST(DampingFloor, WinsOverStiffnessAndSaysWhatItCost) {
  const DesignProblem request = arm(12, 4000);
  const Design design = design_coupling(request);
  const SlowestSwing before = slowest_swing(request, design.spec);
  ASSERT_LT(before.released, 0.1) << "a case that needs it";
  const DampedDesign damped = with_floors(request, design);
  EXPECT_EQ(damped.out_of_reach, "");
  const SlowestSwing after = slowest_swing(request, damped.design.spec);
  EXPECT_GE(after.released, 0.1 - 1e-9);
  EXPECT_GE(after.held, 0.3 - 1e-9);
  EXPECT_LT(after.held, 0.302) << "no more is given up than it takes";
  EXPECT_NEAR(damped.cost_n_per_m, design.translation.shown_stiffness - damped.design.translation.shown_stiffness, 1e-9);
  EXPECT_GT(damped.cost_n_per_m, 100.0);
  EXPECT_GE(damped.design.translation.gain_margin, 2.0 - 1e-9) << "with the certificates of any design";
  EXPECT_EQ(damped.design.status, DesignStatus::kStiffnessReduced);
}

TEST(DampingFloor, CostsNothingWhereItIsKept) {
  const DesignProblem request = arm(6, 300);
  const Design design = design_coupling(request);
  const DampedDesign damped = with_floors(request, design, {0.01, 0.01});
  EXPECT_EQ(damped.cost_n_per_m, 0.0);
  EXPECT_EQ(damped.design.spec, design.spec);
  EXPECT_EQ(damped.out_of_reach, "");
}

TEST(DampingFloor, NamesTheHandThatSwingsByItself) {
  DesignProblem request = arm(6, 1000);
  request.device.translation = {.inertia_min = .035, .inertia_max = .08, .damping = .005, .coulomb_friction = .04, .resolution = 3e-5,
                                .max_effort = 8.5, .max_stiffness = 800};
  request.device.timing.delay_s = 1e-3;
  request.hand.translation = {.mass_min = 0.02, .mass_max = 0.2, .damping_min = 0.5, .damping_max = 8, .stiffness_min = 20, .stiffness_max = 800};
  const DampedDesign damped = with_floors(request, design_coupling(request));
  EXPECT_NE(damped.out_of_reach.find("held (0.2 kg, 0.5 Ns/m, 800 N/m)"), std::string::npos) << damped.out_of_reach;
}

}  // namespace
}  // namespace voxtouch::coupling::design
