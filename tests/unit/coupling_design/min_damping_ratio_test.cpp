// How a loop comes to rest, compared with closed forms; and the cost of minimum damping ratios.
#include "core/coupling/design/min_damping_ratio.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <vector>

#include "core/coupling/design/filter_search.hpp"
#include "core/coupling/design/loop_response.hpp"
#include "core/coupling/design/loop_table.hpp"
#include "core/coupling/design/sampled_loop.hpp"
#include "tests/unit/coupling_design/designer_support.hpp"

namespace voxtouch::coupling::design {
namespace {

LoopController direct() {
  LoopController law;
  law.law = LoopController::Law::kDirect;
  return law;
}

/// Sampled so fast that the loop is the continuous one: b / (2 sqrt(m k)).
TEST(DominantMode, IsTheDampingRatioOfMassSpringAndDamper) {
  for (const double ratio : {0.02, 0.1, 0.3, 0.7}) {
    const double m = 0.1, k = 400.0, b = 2.0 * ratio * std::sqrt(m * k);
    LoopPlant plant{.mass = m, .damping = b, .period_s = 1e-6};
    EXPECT_NEAR(slowest_damping_ratio(plant, direct(), k), ratio, 1e-3);
    plant.hand_stiffness = 0.5 * k;  // hand and wall divide the spring
    EXPECT_NEAR(slowest_damping_ratio(plant, direct(), 0.5 * k), ratio, 1e-3);
  }
}

TEST(DominantMode, IsOneWithoutOscillationAndNegativeIfItGrows) {
  LoopPlant plant{.mass = 0.1, .damping = 40.0, .period_s = 1e-5};
  EXPECT_EQ(slowest_damping_ratio(plant, direct(), 400.0), 1.0) << "overdamped";
  plant.damping = 0.1, plant.period_s = 1e-3;
  EXPECT_LT(
      slowest_damping_ratio(plant, direct(), 2.0 * critical_stiffness(plant, direct()).stiffness),
      0.0);
  EXPECT_NEAR(slowest_damping_ratio(plant, direct(), critical_stiffness(plant, direct()).stiffness),
              0.0, 1e-6);
}

DesignProblem arm(double mass_max, double contact) {
  DesignProblem p;
  p.device.translation = {.inertia_min = 4.8,
                          .inertia_max = mass_max,
                          .damping = 6,
                          .coulomb_friction = 3,
                          .resolution = 2e-5,
                          .max_effort = 150,
                          .max_stiffness = 5000,
                          .effort_bandwidth_hz = 53};
  p.device.timing.delay_s = 2e-3;
  p.hand.translation = {.mass_min = 0.3,
                        .mass_max = 2,
                        .damping_min = 3,
                        .damping_max = 30,
                        .stiffness_min = 50,
                        .stiffness_max = 600};
  p.contact = {10, contact};
  p.goals.free_cap = true;
  p.goals.damping_force_ratio = 0.0, p.goals.velocity_windows = false;
  return p;
}

Design without_minimum(DesignProblem request) {
  request.goals.min_damping = {0.0, 0.0};
  return design_coupling(request);
}

TEST(MinimumDampingRatio, WinsOverStiffnessAndReportsItsCost) {
  const DesignProblem request = arm(12, 4000);
  const Design before = without_minimum(request), damped = design_coupling(request);
  ASSERT_LT(before.swing.released.ratio, 0.1) << "a case that needs it";
  EXPECT_EQ(before.min_damping.gripped, 0.0);
  EXPECT_EQ(damped.min_damping.out_of_reach.ratio, 1.0);
  EXPECT_EQ(damped.min_damping.released, 0.1);
  EXPECT_EQ(damped.min_damping.gripped, 0.3);
  EXPECT_GE(damped.swing.released.ratio, 0.1);
  EXPECT_GE(damped.swing.gripped.ratio, 0.3);
  EXPECT_LT(damped.swing.gripped.ratio, 0.31) << "no more is given up than it takes";
  EXPECT_NEAR(damped.min_damping.cost_n_per_m,
              before.translation.displayed_stiffness - damped.translation.displayed_stiffness,
              1e-9);
  EXPECT_GT(damped.min_damping.cost_n_per_m, 100.0);
  EXPECT_GE(damped.translation.gain_margin, 2.0 - 1e-9) << "with the certificates of any design";
  EXPECT_EQ(damped.status, DesignStatus::kStiffnessReduced);
  ASSERT_FALSE(damped.reasons.empty());
  EXPECT_EQ(damped.reasons.front().what, DesignLimit::kMinDampingCost);
}

/// Damping and stiffness are searched together: with the damping of the design without minima less
/// than half would be left.
TEST(MinimumDampingRatio, IsReachedByDampingBeforeStiffness) {
  const DesignProblem request = arm(12, 4000);
  const Design before = without_minimum(request), damped = design_coupling(request);
  std::vector<AxisProblem> problems = axis_problems(request);
  set_min_damping(request, problems);
  const LoopController law = controller_of(before.spec, problems[0], arm_squared(request));
  const double softened =
      damped_stiffness(problems[0], law, before.translation.displayed_stiffness);
  EXPECT_GT(damped.translation.displayed_stiffness, 2.0 * softened);
  EXPECT_GT(damped.translation.injected_damping, before.translation.injected_damping);
}

TEST(MinimumDampingRatio, CostsNothingIfAlreadyMet) {
  DesignProblem request = arm(6, 300);
  request.goals.min_damping = {0.01, 0.01};
  const Design damped = design_coupling(request);
  EXPECT_EQ(damped.min_damping.cost_n_per_m, 0.0);
  EXPECT_EQ(damped.min_damping.gripped, 0.01);
  EXPECT_EQ(damped.spec, without_minimum(request).spec);
  EXPECT_EQ(damped.min_damping.out_of_reach.ratio, 1.0);
}

DesignProblem stylus() {
  DesignProblem request = arm(6, 800);
  request.device.translation = {.inertia_min = .035,
                                .inertia_max = .08,
                                .damping = .005,
                                .coulomb_friction = .04,
                                .resolution = 3e-5,
                                .max_effort = 8.5,
                                .max_stiffness = 800};
  request.device.timing.delay_s = 1e-3;
  request.hand.translation = {.mass_min = 0.02,
                              .mass_max = 0.2,
                              .damping_min = 0.5,
                              .damping_max = 8,
                              .stiffness_min = 20,
                              .stiffness_max = 800};
  return request;
}

TEST(MinimumDampingRatio, NamesTheForbiddingHandAndSparesTheOthers) {
  const Design damped = design_coupling(stylus());
  const LoopCase& forbids = damped.min_damping.out_of_reach.where;
  EXPECT_TRUE(forbids.gripped);
  EXPECT_EQ(forbids.plant.hand_mass, 0.2);
  EXPECT_EQ(forbids.plant.hand_damping, 0.5);
  EXPECT_EQ(forbids.plant.hand_stiffness, 800.0);
  EXPECT_EQ(damped.min_damping.cost_n_per_m, 0.0);
  EXPECT_GE(damped.swing.released.ratio, 0.1);
}

/// If one hand cannot reach the minimum, it is not required.
TEST(MinimumDampingRatio, IsDroppedForOtherHandsIfOneForbidsIt) {
  DesignProblem request = stylus();
  std::vector<AxisProblem> problems = axis_problems(request);
  ASSERT_LT(set_min_damping(request, problems).ratio, 1.0);
  for (const DesignCase& one : problems[0].cases)
    EXPECT_EQ(one.least_damping_ratio, one.gripped ? 0.0 : 0.1);
}

/// The minimum of rotation is requested separately.
TEST(MinimumDampingRatio, IsOfTranslationUnlessRotationHasItsOwn) {
  DesignProblem request = testing::sim_arm();
  request.goals.min_damping = {};
  std::vector<AxisProblem> problems = axis_problems(request);
  set_min_damping(request, problems);
  for (const DesignCase& one : problems[0].cases)
    EXPECT_EQ(one.least_damping_ratio, one.gripped ? 0.3 : 0.1);
  for (const DesignCase& one : problems[1].cases)
    EXPECT_EQ(one.least_damping_ratio, 0.0);
  request.goals.min_damping = {0.0, 0.0}, request.goals.rotation_min_damping = {0.05, 0.05};
  set_min_damping(request, problems);
  for (const DesignCase& one : problems[0].cases)
    EXPECT_EQ(one.least_damping_ratio, 0.0);
  for (const DesignCase& one : problems[1].cases)
    EXPECT_EQ(one.least_damping_ratio, 0.05);
}

/// Fingers that swing too long by themselves: little damping does not reach the minimum, and much
/// behind a slow filter is late. 794 N/m without minimum damping ratios.
TEST(MinimumDampingRatio, IsFoundBetweenTooLittleDampingAndTooMuch) {
  DesignProblem request = stylus();
  request.device.translation = {.inertia_min = .08,
                                .inertia_max = .16,
                                .damping = .005,
                                .coulomb_friction = .2,
                                .resolution = 2e-5,
                                .max_effort = 22,
                                .max_stiffness = 1000};
  request.contact = {10, 1000};
  const Design damped = design_coupling(request);
  EXPECT_EQ(damped.min_damping.gripped, 0.3);
  EXPECT_EQ(damped.min_damping.out_of_reach.ratio, 1.0);
  EXPECT_GT(damped.translation.displayed_stiffness, 200.0);
}

/// For any device, hand and request: a useful design stays useful, and a minimum reported as kept
/// holds for every hand that permits it.
TEST(MinimumDampingRatio, IsNotBoughtWithAllUsefulStiffness) {
  testing::Random random(11);
  int cost = 0;
  for (int i = 0; i < 60; ++i) {
    DesignProblem request = testing::random_request(random);
    request.goals.min_damping = {};
    const Design before = without_minimum(request), damped = design_coupling(request);
    EXPECT_EQ(before.status == DesignStatus::kInfeasible,
              damped.status == DesignStatus::kInfeasible)
        << i;
    if (damped.min_damping.gripped == 0.0 || request.hand.translation.any_passive)
      continue;
    cost += damped.min_damping.cost_n_per_m > 0.0;
    std::vector<AxisProblem> problems = axis_problems(request);
    set_min_damping(request, problems);
    EXPECT_TRUE(meets_min_damping(request, problems, damped.spec)) << i;
    if (damped.min_damping.out_of_reach.ratio == 1.0) {
      EXPECT_GE(damped.swing.gripped.ratio, 0.3) << i;
    }
    EXPECT_GE(damped.translation.gain_margin, 2.0 - 1e-9) << i;
  }
  EXPECT_GT(cost, 5);
}

/// No damping ratio can be stated for any passive hand.
TEST(MinimumDampingRatio, DoesNotApplyToAnyPassiveHand) {
  DesignProblem request = arm(12, 4000);
  request.hand.translation = {.any_passive = true};
  const Design damped = design_coupling(request);
  EXPECT_EQ(damped.spec, without_minimum(request).spec);
  EXPECT_EQ(damped.min_damping.cost_n_per_m, 0.0);
}

/// The residual damping of a bounded damper in an oscillation that leaves the contact, integrated.
TEST(BoundedDamper, KeepsItsResidualDampingInLargeMotion) {
  const auto left = [](const Complex& ratio, double fraction) {
    double ahead = 0.0;
    constexpr int kSteps = 100'000;
    for (int i = 0; i < kSteps; ++i) {
      const double p = std::numbers::pi * ((i + 0.5) / kSteps - 0.5), law = std::cos(p);
      ahead -= std::sin(p) *
               std::clamp(ratio.real() * law - ratio.imag() * std::sin(p), -law, fraction * law);
    }
    return ahead * (std::numbers::pi / kSteps) / (0.5 * std::numbers::pi * ratio.imag());
  };
  for (const double fraction : {0.2, 0.45, 2.0})
    for (const double size : {0.1, 0.5, 3.0})
      for (const double late : {-0.3, 0.0, 0.3}) {
        const Complex ratio = size * Complex(std::sin(late), std::cos(late));
        EXPECT_NEAR(residual_damping(ratio, fraction), left(ratio, fraction), 1e-3)
            << fraction << ' ' << ratio;
      }
  EXPECT_NEAR(residual_damping({0.0, 1e-6}, 0.45), 1.0, 1e-4) << "a gentle damper is not bounded";
  EXPECT_EQ(residual_damping({0.5, -0.1}, 0.45), 1.0) << "one that drives has nothing to lose";
}

/// Stable at the margin with the full damper and with each residual part; more stiffness without a
/// bound.
TEST(BoundedDamper, IsCertifiedWithItsBoundAndInTheTable) {
  DesignProblem request = arm(12, 4000);
  request.goals.min_damping = {0.0, 0.0},
  request.goals.damping_force_ratio = kDefaultDampingForceRatio;
  const Design bounded = design_coupling(request);
  ASSERT_GT(bounded.translation.injected_damping, 0.0);
  EXPECT_EQ(bounded.spec.damping_force_ratio, kDefaultDampingForceRatio);
  request = stylus(), request.goals.min_damping = {0.0, 0.0},
  request.goals.damping_force_ratio = kDefaultDampingForceRatio;
  AxisProblem problem = axis_problems(request)[0];
  LoopController law = law_of({60.0, 0.707});
  law.injected_damping = 5.0, law.velocity_filter_rad_per_s = 2.0 * std::numbers::pi * 100.0;
  const double as_it_is = critical_case(problem, law).stiffness;
  LoopTable table(problem.cases, std::array{VelocityEstimate{100.0}});
  table.use([&](const DecayingPhasor& at, double period) {
    return filter_response(0.5 * law.w0_rad_per_s * period, 0.707, at);
  });
  EXPECT_NEAR(table.critical(0, 5.0, 0.0, problem.damping_force_ratio, problem.large_swing),
              as_it_is, 0.03 * as_it_is);
  problem.damping_force_ratio = 0.0;
  EXPECT_LT(as_it_is, 0.9 * critical_case(problem, law).stiffness);
  request.goals.damping_force_ratio = 0.0;
  EXPECT_EQ(axis_problems(request)[0].damping_force_ratio, 0.0);
  EXPECT_EQ(design_coupling(request).spec.damping_force_ratio, 0.0);
}

/// A requested damper is dropped if, with the filter's lag, less than two thirds would be left.
TEST(BoundedDamper, RequestedRatioCostsAtMostAThirdOfStiffness) {
  testing::Random random(12);
  int kept = 0, given_up = 0;
  for (int i = 0; i < 40; ++i) {
    DesignProblem request = testing::random_request(random);
    request.goals.damping_force_ratio = kDefaultDampingForceRatio;
    const Design design = design_coupling(request);
    request.goals.damping_force_ratio = 0.0;
    const Design unbounded = design_coupling(request);
    if (design.spec.damping_force_ratio == 0.0) {
      EXPECT_EQ(design.spec, unbounded.spec) << i;
      EXPECT_TRUE(testing::has_reason(design, DesignLimit::kNoDampingForceRatio)) << i;
      ++given_up;
    } else if (design.translation.injected_damping > 0.0 && !request.device.gives_torque &&
               unbounded.status != DesignStatus::kInfeasible) {
      EXPECT_GE(design.translation.displayed_stiffness,
                0.66 * unbounded.translation.displayed_stiffness)
          << i;
      ++kept;
    }
  }
  EXPECT_GT(kept, 0);
  EXPECT_GT(given_up, 0);
}

/// The standard ratio if it leaves two thirds; a larger one only if the smaller ones leave less
/// than nine tenths; none only after all were tried. The reasons state the result of the chosen
/// ratio, of the standard one and of none.
TEST(BoundedDamper, HasTheSmallestSufficientRatio) {
  testing::Random random(12);
  std::map<double, int> taken;
  for (int i = 0; i < 60; ++i) {
    DesignProblem request = testing::random_request(random);
    request.goals.damping_force_ratio.reset();
    if (i % 2 == 0)
      request.goals.min_damping = MinDampingRatios{};
    const auto with = [&](double fraction) {
      DesignProblem asked = request;
      asked.goals.damping_force_ratio = fraction;
      return design_coupling(asked);
    };
    const auto displayed = [](const Design& d) {
      return d.translation.displayed_stiffness / d.translation.requested_stiffness;
    };
    const Design design = design_coupling(request), none = with(0.0);
    if (design.translation.injected_damping <= 0.0 || design.status == DesignStatus::kInfeasible)
      continue;
    double expected = 0.0;
    for (const double fraction : kDampingForceRatios) {
      const Design bounded = with(fraction);  // not kept below two thirds
      if (bounded.spec.damping_force_ratio != fraction)
        continue;
      if (fraction != kDefaultDampingForceRatio &&
          !(bounded.translation.displayed_stiffness >= 0.9 * none.translation.displayed_stiffness))
        continue;
      expected = fraction;
      EXPECT_EQ(design.spec, bounded.spec) << i;
      break;
    }
    EXPECT_EQ(design.spec.damping_force_ratio, expected) << i;
    ++taken[design.spec.damping_force_ratio];
    if (design.spec.damping_force_ratio == kDefaultDampingForceRatio)
      continue;
    const bool bounded = design.spec.damping_force_ratio > 0.0;
    const auto reason = std::ranges::find(
        design.reasons,
        bounded ? DesignLimit::kDampingForceRatio : DesignLimit::kNoDampingForceRatio,
        &DesignReason::what);
    ASSERT_NE(reason, design.reasons.end()) << i;
    const Design standard = with(kDefaultDampingForceRatio);
    if (bounded) {
      EXPECT_EQ(reason->values[0], design.spec.damping_force_ratio) << i;
      EXPECT_EQ(reason->values[1], kDefaultDampingForceRatio) << i;
      if (standard.spec.damping_force_ratio == kDefaultDampingForceRatio) {
        EXPECT_NEAR(reason->values[2], displayed(standard), 1e-9) << i;
      }
      EXPECT_NEAR(reason->values[3], displayed(design), 1e-9) << i;
      EXPECT_NEAR(reason->values[4], displayed(none), 1e-9) << i;
    } else {
      EXPECT_EQ(reason->values[0], kDefaultDampingForceRatio) << i;
      EXPECT_NEAR(reason->values[2], displayed(design), 1e-9) << i;
    }
  }
  for (const auto& [fraction, times] : taken)
    std::printf("share %.2g: %d\n", fraction, times);
  EXPECT_GE(taken.size(), 4U);
  EXPECT_GT(taken[0.0], 0);
}

/// The table that proposes: no worse than the exact answer by more than a few percent, and never
/// the better by as much.
TEST(MinimumDampingRatio, IsProposedByATableThatIncludesIt) {
  DesignProblem request = arm(6, 4000);
  std::vector<AxisProblem> problems = axis_problems(request);
  set_min_damping(request, problems);
  const FilterSetting shape{60.0, 0.707};
  LoopController law = law_of(shape);
  law.velocity_filter_rad_per_s = 2.0 * std::numbers::pi * 100.0;
  LoopTable table(problems[0].cases, std::array{VelocityEstimate{100.0}}, LoopLimit::kDamped);
  table.use([&](const DecayingPhasor& at, double period) {
    return filter_response(0.5 * law.w0_rad_per_s * period, shape.damping_ratio, at);
  });
  for (const double damping : {60.0, 100.0, 140.0}) {
    law.injected_damping = damping;
    const double exact = damped_stiffness(problems[0], law, 4000.0);
    EXPECT_NEAR(table.critical(0, damping), exact, 0.03 * exact) << damping;
  }
}

}  // namespace
}  // namespace voxtouch::coupling::design
