// The other kinds of coupling, the choice among them, limit cycles, and the table used by the
// search.
#include <gtest/gtest.h>

#include <cmath>

#include "core/coupling/design/certificates.hpp"
#include "core/coupling/design/filter_search.hpp"
#include "core/coupling/design/limit_cycle.hpp"
#include "core/coupling/design/loop_table.hpp"
#include "core/coupling/design/min_damping_ratio.hpp"
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
  r.device.translation.coulomb_friction =
      1.001 * limit_cycle_friction(0.577, 2000.0, r.device.translation.resolution);
  EXPECT_EQ(designed(r).translation.limit_cycle_bound, 0.0);
  r.device.translation.coulomb_friction *= 0.99;
  EXPECT_GT(designed(r).translation.limit_cycle_bound, 0.0);
}

TEST(LimitCycle, TheNormIsReachedByTheWorstErrors) {
  // A constant error q finally moves a gripped device by q K k / (k_h + K k): the sum of the signed
  // response.
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
  const auto gain = [&](double contact) { return pulse_gain(p, law, contact, 1.0, 0.0); };
  EXPECT_GE(gain(200.0), at_rest * (1 - 1e-6));
  EXPECT_LT(gain(200.0), 10.0);
  // Overdamped and slow, the response has one sign and the norm is that very figure.
  p.hand_damping = 60.0, law.w0_rad_per_s = 2000.0;
  EXPECT_NEAR(gain(20.0), 20.0 / 320.0, 1e-4 * 20.0 / 320.0);
  EXPECT_NEAR(pulse_gain(p, law, 20.0, 0.0, 1.0), 1.0 / 320.0, 1e-4 / 320.0)
      << "an effort of 1 for good";
  // Near its stability limit it grows.
  const double limit = critical_stiffness(p, law).stiffness;
  EXPECT_GT(gain(0.99 * limit), 5.0 * gain(0.5 * limit));
}

TEST(SpringDamper, ForAnyPassiveHandIsTheDiscreteLlewellynOptimum) {
  DesignProblem r = robot(2.0, 5.0, 50.0);
  r.goals.kind = "spring_damper";
  r.hand.translation.any_passive = true;
  const Design d = designed(r);
  const LoopTiming slow = slowest(r.device.timing);
  const int n = whole_delay(slow, 3e-3);
  EXPECT_EQ(n, 6);  // (2 + 2.2 + 3) ms in periods of 1.2 ms
  EXPECT_NEAR(
      2.0 * llewellyn_damping(d.spec.stiffness_n_per_m, d.spec.damping_ns_per_m, slow.period_s, n),
      50.0, 1e-6);
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
      for (double k = 1.0; k < 1e8; k *= 2.7)
        ASSERT_LT(spectral_radius(one.plant, law, k), 1.0) << k;
  }
}

TEST(SpringDamper, OfForceAndTorqueUsesBothDampings) {
  DesignProblem r = sim_arm();
  r.goals.kind = "spring_damper";
  r.hand.translation.any_passive = r.hand.rotation.any_passive = true;
  const Design d = designed(r);
  const LoopTiming slow = slowest(r.device.timing);
  const double needed = llewellyn_damping(d.spec.stiffness_n_per_m, d.spec.damping_ns_per_m,
                                          slow.period_s, whole_delay(slow, 3e-3));
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
    const double displayed =
        d.status == DesignStatus::kInfeasible ? 0.0 : d.translation.displayed_stiffness;
    if (std::string(kind) == "shaping_filter")
      filter = displayed;
    most = std::max(most, displayed);
  }
  EXPECT_GT(most, 1.5 * filter);
  EXPECT_EQ(best.translation.displayed_stiffness, most);
  EXPECT_NE(best.spec.kind, "shaping_filter");
}

/// Between a tenth and half more: direct. The simulated stylus with a virtual tool requests it, 518
/// N/m for 371.
TEST(Auto, KeepsTheFilterUnlessDroppingItGainsHalf) {
  DesignProblem r = sim_stylus();
  r.goals = DesignGoals{};
  r.goals.free_cap = true;
  r.contact = {1e-3, 800.0};
  r.goals.kind = "shaping_filter";
  const double filter = designed(r).translation.displayed_stiffness;
  r.goals.kind = "auto";
  const Design best = designed(r);
  EXPECT_EQ(best.spec.kind, "direct");
  EXPECT_GT(best.translation.displayed_stiffness, 1.1 * filter);
  EXPECT_LT(best.translation.displayed_stiffness, 1.5 * filter)
      << "else this says nothing of what is enough";
  EXPECT_NE(best.reasons.front().what, DesignLimit::kWithoutFilter) << "which is no limit";
}

TEST(LoopTable, IsWithinAPercentOfTheExactLimit) {
  Random random(5);
  double worst = 0.0;
  for (int i = 0; i < 60; ++i) {
    const DesignProblem r = random_request(random);
    const std::vector<DesignCase> cases = axis_problems(r)[0].cases;
    LoopController law = random_filter(random);
    if (law.damping_ratio < 0.5)
      law.damping_ratio = 0.577;
    law.velocity_filter_rad_per_s = 2.0 * std::numbers::pi * 100.0;
    if (random.chance(0.5))
      law.injected_damping =
          random.uniform(0.0, 0.5) * critical_damping(axis_problems(r)[0], {100.0});
    if (law.w0_rad_per_s * slowest(r.device.timing).period_s > 0.7)
      continue;
    LoopTable table(cases, std::array{VelocityEstimate{100.0}});
    table.use([&](const DecayingPhasor& at, double period) {
      return filter_response(0.5 * law.w0_rad_per_s * period, law.damping_ratio, at);
    });
    const double exact = critical_case(axis_problems(r)[0], law).stiffness;
    if (exact < 0.1)
      continue;
    const double off = std::abs(table.critical(0, law.injected_damping) / exact - 1.0);
    worst = std::max(worst, off);
    EXPECT_LT(off, 0.015) << i;
  }
  std::printf("worst %.2g\n", worst);
}

/// The same value whether the damping is injected or part of the law.
TEST(LoopTable, InjectsDampingAsALawWould) {
  Random random(6);
  int differ = 0;
  for (int i = 0; i < 200; ++i) {
    const DesignProblem r = random_request(random);
    const AxisProblem problem = axis_problems(r)[0];
    const VelocityEstimate velocity = kVelocityEstimates[static_cast<std::size_t>(
        random.below(static_cast<int>(kVelocityEstimates.size())))];
    const LoopController shape = random_filter(random);
    const DesignCase& one =
        problem
            .cases[static_cast<std::size_t>(random.below(static_cast<int>(problem.cases.size())))];
    const auto filter = [&](const DecayingPhasor& at, double period) {
      return filter_response(0.5 * shape.w0_rad_per_s * period, shape.damping_ratio, at);
    };
    const LoopResponse plant(one.plant, {.law = LoopController::Law::kDirect});
    const VelocityResponse speed(one.plant.period_s, velocity.filter_rad_per_s(), velocity.window);
    LoopTable table({one}, std::array{velocity}), whole({one}, {});
    table.use(filter);
    for (const double fraction : {1.0, 0.03, 0.3, 0.003, 0.6, 0.1}) {
      const double damping =
          fraction * inner_limit(one.plant, velocity.filter_rad_per_s(), velocity.window).damping;
      if (!std::isfinite(damping))
        continue;
      whole.use([&](const DecayingPhasor& at, double period) {
        return filter(at, period) / (1.0 + damping * plant.damped_plant(at) * speed(at));
      });
      const double expected = whole.critical(0, 0.0), found = table.critical(0, damping);
      if (std::isinf(expected) && std::isinf(found))
        continue;
      differ += !(std::abs(found - expected) <= 1e-7 * expected);
    }
  }
  EXPECT_EQ(differ, 0);
}

/// If the table claims that the target is reached and the exact evaluation does not confirm it, the
/// stiffest setting is still searched among the table's entries. Entries that are only known to be
/// too low are not used: 627 N/m instead of 556 N/m.
TEST(FilterSearch, FindsTheStiffestIfTheTableIsWrong) {
  Random random(4712);
  DesignProblem r;
  for (int i = 0; i < 72; ++i)
    r = random_request(random);
  r.goals.min_damping = {}, r.goals.damping_force_ratio = kDefaultDampingForceRatio,
  r.goals.velocity_windows = true;
  EXPECT_NEAR(designed(r).translation.displayed_stiffness, 627.475, 0.001);
}

/// No tested setting, evaluated exactly, displays more than a tenth above the chosen one, plus the
/// table's uncertainty.
TEST(FilterSearch, ReachesNineTenthsOfTheBest) {
  Random random(31);
  int looked_at = 0;
  for (int i = 0; i < 40; ++i) {
    DesignProblem r = random_request(random);
    r.goals.kind = "shaping_filter", r.goals.velocity_windows = true,
    r.goals.damping_force_ratio = i % 2 == 0 ? kDefaultDampingForceRatio : 0.0;
    const AxisProblem problem = axis_problems(r)[0];
    if (problem.hand.any_passive)
      continue;
    const FilterChoice choice =
        search_filter({problem}, filter_settings(r), r.goals.allow_injected_damping, true);
    if (choice.status != DesignStatus::kStiffnessReduced)
      continue;
    const auto shows = [&](const FilterSetting& shape, const VelocityEstimate& velocity,
                           double damping, double enough) {
      LoopController law = law_of(shape);
      law.injected_damping = damping, law.use(velocity);
      return std::min(problem.target, certified_stiffness(problem, law, enough));
    };
    const double taken = shows(choice.shape, choice.velocity, choice.damping[0], 0.0);
    double best = 0.0;
    for (const FilterSetting& shape : filter_settings(r))
      for (const VelocityEstimate& velocity : kVelocityEstimates)
        for (int level = 0; level <= (r.goals.allow_injected_damping ? 10 : 0); level += 2)
          best = std::max(
              best, shows(shape, velocity, 0.1 * level * damping_limit(problem, velocity), best));
    EXPECT_GE(taken, 0.9 * 0.97 * best) << i;
    ++looked_at;
  }
  EXPECT_GT(looked_at, 8);
}

TEST(InnerLimits, KeepPlantsAndVelocitiesApart) {
  DesignProblem r = stylus();
  std::vector<DesignCase> cases = axis_problems(r)[0].cases;
  ASSERT_GT(cases.size(), 2u);
  for (int again = 0; again < 2; ++again)
    for (const VelocityEstimate& v : kVelocityEstimates)
      for (const DesignCase& one : cases) {
        ASSERT_EQ(cases[0].inner->of(one.plant, v.filter_rad_per_s(), v.window).damping,
                  inner_limit(one.plant, v.filter_rad_per_s(), v.window).damping);
        ASSERT_EQ(one.inner->of(one.plant, v.filter_rad_per_s(), v.window).damping,
                  inner_limit(one.plant, v.filter_rad_per_s(), v.window).damping);
      }
}

TEST(MeetsMinDamping, DoesNotDependOnTheOrderOfCases) {
  DesignProblem r = stylus();
  r.goals.min_damping = {};
  std::vector<AxisProblem> problems = axis_problems(r);
  LoopController law = law_of({kInfinity, 1.0});
  law.injected_damping = 2.0, law.use({100.0});
  for (DesignCase& one : problems[0].cases)
    one.least_damping_ratio = one.gripped ? 0.05 : 0.01;
  int kept = 0, broken = 0;
  for (const double contact : {1.0, 5.0, 20.0, 50.0, 100.0, 200.0, 400.0, 800.0}) {
    const bool keeps = meets_min_damping(problems[0], law, contact);
    ++(keeps ? kept : broken);
    for (std::size_t i = 0; i < problems[0].cases.size(); ++i) {
      std::size_t first = i;
      EXPECT_EQ(meets_min_damping(problems[0], law, contact, first), keeps) << contact << ' ' << i;
      EXPECT_TRUE(!keeps || first == i);
    }
  }
  EXPECT_GT(kept, 0);
  EXPECT_GT(broken, 0);
}

}  // namespace designer_kinds_test
}  // namespace voxtouch::coupling::design
