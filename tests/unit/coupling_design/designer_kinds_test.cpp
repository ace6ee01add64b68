// The other kinds of coupling, the choice among them, limit cycles, and the table that the search looks up.
#include <gtest/gtest.h>

#include <cmath>

#include "core/coupling/design/certificates.hpp"
#include "core/coupling/design/limit_cycle.hpp"
#include "core/coupling/design/loop_table.hpp"
#include "tests/unit/coupling_design/designer_support.hpp"

namespace voxtouch::coupling::design {
namespace designer_kinds_test {

using namespace testing;

TEST(LimitCycle, IsRemovedByFrictionOnly) {
  DesignProblem r = robot(2.0, 5.0, 50.0);
  EXPECT_EQ(designed(r).translation.limit_cycle_bound, 0.0);
  r.device.translation.coulomb_friction = 0.0;
  const double bound = designed(r).translation.limit_cycle_bound;
  EXPECT_GT(bound, 0.1 * r.device.translation.resolution);
  EXPECT_LT(bound, 20.0 * r.device.translation.resolution);
  r.device.translation.coulomb_friction = 1.001 * limit_cycle_friction(0.577, 2000.0, r.device.translation.resolution);
  EXPECT_EQ(designed(r).translation.limit_cycle_bound, 0.0);
  r.device.translation.coulomb_friction *= 0.99;
  EXPECT_GT(designed(r).translation.limit_cycle_bound, 0.0);
}

TEST(LimitCycle, TheNormIsReachedByTheWorstErrors) {
  // A constant error q moves a held device by q K k / (k_h + K k) in the end: the sum of the response without its signs' help.
  LoopPlant p{.mass = 0.1,
              .damping = 0.5,
              .hand_mass = 0.05,
              .hand_damping = 4.0,
              .hand_stiffness = 300.0,
              .period_s = 1e-3,
              .delay_s = 1.5e-3,
              .effort_lag_s = 1e-3};
  LoopController law;
  law.w0_rad_per_s = 300.0;
  const double at_rest = 200.0 / (200.0 + 300.0);
  EXPECT_GE(quantisation_gain(p, law, 200.0), at_rest * (1 - 1e-6));
  EXPECT_LT(quantisation_gain(p, law, 200.0), 10.0);
  // Overdamped and slow, the response has one sign and the norm is that very figure.
  p.hand_damping = 60.0, law.w0_rad_per_s = 2000.0;
  EXPECT_NEAR(quantisation_gain(p, law, 20.0), 20.0 / 320.0, 1e-4 * 20.0 / 320.0);
  // Near its stability limit it grows.
  const double limit = critical_stiffness(p, law).stiffness;
  EXPECT_GT(quantisation_gain(p, law, 0.99 * limit), 5.0 * quantisation_gain(p, law, 0.5 * limit));
}

TEST(SpringDamper, ForAnyPassiveHandIsTheDiscreteLlewellynOptimum) {
  DesignProblem r = robot(2.0, 5.0, 50.0);
  r.goals.kind = "spring_damper";
  r.hand.translation.any_passive = true;
  const Design d = designed(r);
  const LoopTiming slow = slowest(r.device.timing);
  const int n = whole_delay(slow, 3e-3);
  EXPECT_EQ(n, 6);  // (2 + 2.2 + 3) ms in periods of 1.2 ms
  EXPECT_NEAR(2.0 * llewellyn_damping(d.spec.stiffness_n_per_m, d.spec.damping_ns_per_m, slow.period_s, n), 50.0, 1e-6);
  EXPECT_TRUE(d.translation.passive);
  EXPECT_NEAR(d.translation.gain_margin, 2.0, 1e-6);
  r.hand.translation.any_passive = false;
  const Design ranged = designed(r);
  EXPECT_GE(ranged.spec.stiffness_n_per_m, d.spec.stiffness_n_per_m);
  EXPECT_TRUE(std::isinf(ranged.spec.stiffness_cap_n_per_m));
  EXPECT_GE(ranged.translation.gain_margin, 2.0);
}

TEST(SpringDamper, HoldsForContactsOfEveryStiffness) {
  for (DesignProblem r : {robot(2.0, 5.0, 50.0), stylus()}) {
    r.goals.kind = "spring_damper";
    const Design d = designed(r);
    LoopController law = law_of_translation(r, d.spec);
    law.stiffness *= 1.99, law.damping *= 1.99;
    const AxisProblem problem = axis_problems(r)[0];
    for (const DesignCase& one : problem.cases)
      for (double k = 1.0; k < 1e8; k *= 2.7) ASSERT_LT(spectral_radius(one.plant, law, k), 1.0) << k;
  }
}

TEST(SpringDamper, OfForceAndTorqueDrawsOnBothDampings) {
  DesignProblem r = sim_arm();
  r.goals.kind = "spring_damper";
  r.hand.translation.any_passive = r.hand.rotation.any_passive = true;
  const Design d = designed(r);
  const LoopTiming slow = slowest(r.device.timing);
  const double needed =
      llewellyn_damping(d.spec.stiffness_n_per_m, d.spec.damping_ns_per_m, slow.period_s, whole_delay(slow, 3e-3));
  EXPECT_NEAR(needed * (1.0 / 30.0 + arm_squared(r) / 0.3), 0.5, 1e-6);
  EXPECT_NEAR(d.translation.gain_margin, d.rotation.gain_margin, 1e-6);
}

TEST(Auto, KeepsTheFilterUnlessAnotherShowsATenthMore) {
  DesignProblem r = robot(2.0, 5.0, 50.0);
  r.goals.kind = "auto";
  EXPECT_EQ(designed(r).spec.kind, "shaping_filter");
  r.contact.all_points = 400.0;
  EXPECT_EQ(designed(r).status, DesignStatus::kAsRequested);
  r.contact.all_points = 1e5, r.goals.free_cap = true, r.goals.allow_injected_damping = false;
  const Design best = designed(r);
  double filter = 0.0, most = 0.0;
  for (const char* kind : {"shaping_filter", "direct", "spring_damper"}) {
    r.goals.kind = kind;
    const Design d = designed(r);
    const double shown = d.status == DesignStatus::kInfeasible ? 0.0 : d.translation.shown_stiffness;
    if (std::string(kind) == "shaping_filter") filter = shown;
    most = std::max(most, shown);
  }
  EXPECT_GT(most, 1.5 * filter);
  EXPECT_EQ(best.translation.shown_stiffness, most);
  EXPECT_NE(best.spec.kind, "shaping_filter");
}

/// Between a tenth and half as much again: direct. The simulated stylus as a virtual tool asks for it, 570 N/m for 384.
TEST(Auto, LeavesTheFilterOutForLessThanHalfAsMuchAgain) {
  DesignProblem r = sim_stylus();
  r.goals = DesignGoals{};
  r.goals.free_cap = true;
  r.contact = {1e-3, 800.0};
  r.goals.kind = "shaping_filter";
  const double filter = designed(r).translation.shown_stiffness;
  r.goals.kind = "auto";
  const Design best = designed(r);
  EXPECT_EQ(best.spec.kind, "direct");
  EXPECT_GT(best.translation.shown_stiffness, 1.1 * filter);
  EXPECT_LT(best.translation.shown_stiffness, 1.5 * filter) << "else this says nothing of what is enough";
  EXPECT_EQ(best.reasons.front().find("Without the shaping filter"), std::string::npos) << "which is no limit: " << best.reasons.front();
}

TEST(LoopTable, IsWithinAPercentOfTheExactLimit) {
  Random random(5);
  double worst = 0.0;
  for (int i = 0; i < 60; ++i) {
    const DesignProblem r = random_request(random);
    const std::vector<DesignCase> cases = axis_problems(r)[0].cases;
    LoopController law = random_filter(random);
    if (law.damping_ratio < 0.5) law.damping_ratio = 0.577;
    law.velocity_filter_rad_per_s = 2.0 * std::numbers::pi * 100.0;
    if (random.chance(0.5))
      law.injected_damping = random.uniform(0.0, 0.5) * critical_damping(axis_problems(r)[0], {100.0});
    if (law.w0_rad_per_s * slowest(r.device.timing).period_s > 0.7) continue;
    LoopTable table(cases, std::array{VelocityEstimate{100.0}});
    table.use([&](const DecayingPhasor& at, double period) {
      return filter_response(0.5 * law.w0_rad_per_s * period, law.damping_ratio, at);
    });
    const double exact = critical_case(axis_problems(r)[0], law).stiffness;
    if (exact < 0.1) continue;
    const double off = std::abs(table.critical(0, law.injected_damping) / exact - 1.0);
    worst = std::max(worst, off);
    EXPECT_LT(off, 0.015) << i;
  }
  std::printf("worst %.2g\n", worst);
}

}  // namespace designer_kinds_test
}  // namespace voxtouch::coupling::design
