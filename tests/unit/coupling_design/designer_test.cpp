#include "core/coupling/design/designer.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <chrono>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <stdexcept>

#include "core/coupling/design/axis_verdict.hpp"
#include "core/coupling/design/certificates.hpp"
#include "core/coupling/design/filter_search.hpp"
#include "core/coupling/design/limit_cycle.hpp"
#include "core/coupling/design/loop_table.hpp"
#include "tests/unit/coupling_design/designer_support.hpp"

namespace voxtouch::coupling::design {
namespace designer_test {

using namespace testing;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Timed {
  Design design;
  double milliseconds = 0.0;
};
Timed timed(const DesignProblem& request) {
  const auto begin = std::chrono::steady_clock::now();
  Timed out{design_coupling(request), 0.0};
  out.milliseconds = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

void print(const DesignProblem& r, const Timed& t) {
  const Design& d = t.design;
  std::printf(
      "%s: %s, %s, %.3g Hz, d %.3g, K %.3g, c %.4g N/m, r %.3g Ns/m, cap %.4g N/m %.4g Nm/rad, B %.3g Ns/m %.3g "
      "Nms/rad "
      "at %g Hz, passivity %.3g %.3g, lag %.3g ms, approach %.3g m/s [%.1f ms]\n",
      r.device.name.c_str(), std::string(name_of(d.status)).c_str(), d.spec.kind.c_str(), d.spec.cutoff_hz,
      d.spec.damping_ratio, d.spec.gain, d.spec.stiffness_n_per_m, d.spec.damping_ns_per_m,
      d.spec.stiffness_cap_n_per_m, d.spec.stiffness_cap_nm_per_rad, d.spec.injected_damping_ns_per_m,
      d.spec.injected_damping_nms_per_rad, d.spec.velocity_filter_hz, d.spec.passivity_damping_limit_ns_per_m,
      d.spec.passivity_damping_limit_nms_per_rad, 1e3 * d.lag_s, d.max_approach_m_per_s, t.milliseconds);
  for (const AxisDesign* a : {&d.translation, &d.rotation})
    if (a->wanted_stiffness > 0.0)
      std::printf(
          "  shown %.4g of %.4g, critical %.4g, margin %.4g, %s, passive up to %.4g, limit cycle %.3g, damping "
          "required %.3g "
          "or %.3g; %s\n",
          a->shown_stiffness, a->wanted_stiffness, a->critical_stiffness, a->gain_margin,
          a->passive ? "passive" : "not passive", a->passive_stiffness, a->limit_cycle_bound, a->damping_required,
          a->damping_required_any_cutoff, a->worst_case_text.c_str());
  for (const std::string& s : d.reasons) std::printf("  - %s\n", s.c_str());
  for (const std::string& s : d.remedies) std::printf("  + %s\n", s.c_str());
}

inline Design designed(const DesignProblem& request) { return design_coupling(request); }

double margin_of(const DesignProblem& r, double cutoff_hz, double ratio, double damping, double filter_hz,
                 double stiffness) {
  CouplingSpec spec;
  spec.cutoff_hz = cutoff_hz, spec.damping_ratio = ratio, spec.injected_damping_ns_per_m = damping;
  spec.velocity_filter_hz = filter_hz, spec.gain = stiffness / r.contact.all_points;
  return judge_coupling(r, spec).translation.gain_margin;
}

// --- The published examples. Their mass range is not given; 0.05 to 0.1 kg is used here.

TEST(PublishedExample, AFreeStylusWithoutInjectedDampingIsInfeasible) {
  DesignProblem r = stylus();
  r.goals.allow_injected_damping = false;
  const Design d = designed(r);
  EXPECT_EQ(d.status, DesignStatus::kInfeasible);
  EXPECT_NEAR(d.translation.shown_stiffness, 0.38, 0.005);
  // The published 13 Ns/m scale this result to 1000 N/m: the limit for a linear contact. Rule P, which also covers contacts that
  // only push, asks for more.
  EXPECT_NEAR(r.device.translation.damping * 1000.0 / d.translation.shown_stiffness, 13.0, 0.5);
  EXPECT_GT(d.translation.damping_required_any_cutoff, 13.0);
  EXPECT_LT(d.translation.damping_required_any_cutoff, 20.0);
}

TEST(PublishedExample, AFreeStylusWithInjectedDampingShowsPart) {
  const DesignProblem r = stylus();
  const Design d = designed(r);
  EXPECT_EQ(d.status, DesignStatus::kStiffnessReduced);
  EXPECT_EQ(d.spec.cutoff_hz, 60.0);
  // Published: 6.2 Ns/m and 288 N/m. Those are certified here too; but nine tenths of that damping are within a tenth of the
  // best stiffness, and the gentler one of such is taken.
  EXPECT_NEAR(margin_of(r, 60.0, 1.0, 6.18, 50.0, 288.0), 2.0, 0.04);
  EXPECT_NEAR(d.spec.injected_damping_ns_per_m, 0.9 * 6.18, 0.01);
  EXPECT_GT(d.translation.shown_stiffness, 0.9 * 288.0);
}

TEST(PublishedExample, AFirmlyHeldStylusShowsPartWithoutDamping) {
  DesignProblem r = stylus();
  r.hand.translation = kFirmPen;
  r.goals.allow_injected_damping = false;
  const Design d = designed(r);
  EXPECT_EQ(d.status, DesignStatus::kStiffnessReduced);
  EXPECT_EQ(d.spec.cutoff_hz, 80.0);
  EXPECT_NEAR(d.translation.shown_stiffness, 230.0, 2.0);
}

TEST(PublishedExample, ADampedRobotNeedsOnlyMoreBandwidth) {
  const Design d = designed(robot(2.0, 5.0, 50.0));
  EXPECT_EQ(d.status, DesignStatus::kBandwidthRaised);
  EXPECT_EQ(d.spec.cutoff_hz, 40.0);
  EXPECT_EQ(d.spec.gain, 1.0);
  EXPECT_EQ(d.spec.injected_damping_ns_per_m, 0.0);
}

TEST(PublishedExample, ASoftWallIsShownAsRequested) {
  DesignProblem r = robot(2.0, 5.0, 50.0);
  r.contact.all_points = 400.0;
  const Design d = designed(r);
  EXPECT_EQ(d.status, DesignStatus::kAsRequested);
  EXPECT_EQ(d.spec.cutoff_hz, 5.0);
  EXPECT_EQ(d.spec.gain, 1.0);
  EXPECT_TRUE(d.remedies.empty());
}

TEST(PublishedExample, ALightlyDampedRobotGetsDamping) {
  const Design d = designed(robot(2.0, 10.0, 10.0));
  EXPECT_EQ(d.status, DesignStatus::kDampingAdded);
  EXPECT_EQ(d.spec.cutoff_hz, 80.0);
  EXPECT_EQ(d.spec.gain, 1.0);
  // Published: 35 Ns/m, half of what the noise of 200 N allows behind 200 Hz. It is certified here too; three tenths of what is
  // allowed behind 100 Hz, which is less, hold as well.
  EXPECT_GE(margin_of(robot(2.0, 10.0, 10.0), 80.0, 0.577, 34.95, 200.0, 2000.0), 2.0);
  EXPECT_NEAR(d.spec.injected_damping_ns_per_m, 32.2, 0.1);
  EXPECT_EQ(d.spec.velocity_filter_hz, 100.0);
}

// --- Certificates, looked at from outside.

/// Cases between the corners, and timings between nominal and slowest, that the designer has not looked at.
std::vector<LoopPlant> finer_cases(const AxisProblem& problem, Random& random, int count) {
  std::vector<LoopPlant> out;
  const HandRange& hand = problem.hand;
  const LoopTiming slow = slowest(problem.timing);
  for (int i = 0; i < count; ++i) {
    LoopPlant p;
    const double late = random.uniform(0.0, 1.0);
    p.mass = random.uniform(problem.model.inertia_min, problem.model.inertia_max);
    p.damping = problem.model.damping * random.uniform(1.0, 1.5);
    p.period_s = std::lerp(problem.timing.period_s, slow.period_s, late);
    p.delay_s = std::lerp(problem.timing.delay_s, slow.delay_s, late);
    p.effort_lag_s = effort_lag_s(problem.model);
    const bool alone = hand.any_passive ? random.chance(0.2) : hand.may_release && random.chance(0.3);
    if (!alone && hand.any_passive) {
      p.hand_mass = random.log(1e-3, 10.0), p.hand_damping = random.log(1e-4, 10.0),
      p.hand_stiffness = random.log(1.0, 3e4);
    } else if (!alone) {
      p.hand_mass = random.uniform(hand.mass_min, hand.mass_max);
      p.hand_damping = random.uniform(hand.damping_min, hand.damping_max);
      p.hand_stiffness = random.uniform(hand.stiffness_min, hand.stiffness_max);
    }
    out.push_back(p);
  }
  return out;
}

TEST(Design, IsStableBetweenTheCasesThatItLookedAt) {
  Random random(20240517);
  std::map<std::string, int> statuses;
  int loops = 0;
  for (int i = 0; i < 80; ++i) {
    const DesignProblem r = random_request(random);
    const Timed t = timed(r);
    ++statuses[std::string(name_of(t.design.status)) + " " + t.design.spec.kind];
    if (t.design.translation.shown_stiffness == 0.0) continue;
    const AxisProblem problem = axis_problems(r)[0];
    const LoopController law = law_of_translation(r, t.design.spec);
    const bool series = law.law == LoopController::Law::kSpringDamper;
    for (const LoopPlant& plant : finer_cases(problem, random, 40))
      for (const double share : {0.001, 0.1, 1.0, 0.99 * r.goals.gain_margin}) {
        LoopController scaled = law;
        if (series) scaled.stiffness *= share, scaled.damping *= share;
        const double k = series ? share * r.contact.all_points : share * t.design.translation.shown_stiffness;
        ++loops;
        ASSERT_LT(spectral_radius(plant, scaled, k), 1.0)
            << "request " << i << " " << t.design.spec.kind << " share " << share << " m " << plant.mass << "+"
            << plant.hand_mass << " b_h " << plant.hand_damping << " k_h " << plant.hand_stiffness << " T "
            << plant.period_s;
      }
  }
  for (const auto& [word, count] : statuses) std::printf("%4d %s\n", count, word.c_str());
  std::printf("%d loops\n", loops);
}

TEST(Design, InjectsNoMoreThanTheInnerLoopAndTheNoiseAllow) {
  Random random(41);
  int damped = 0;
  for (int i = 0; i < 60; ++i) {
    const DesignProblem r = random_request(random);
    const Design d = designed(r);
    const double b = d.spec.injected_damping_ns_per_m, w = 2.0 * std::numbers::pi * d.spec.velocity_filter_hz;
    if (b == 0.0) continue;
    ++damped;
    EXPECT_TRUE(r.goals.allow_injected_damping);
    for (const LoopPlant& plant : finer_cases(axis_problems(r)[0], random, 30))
      ASSERT_LE(b, 0.501 * critical_damping(plant, w)) << i;
    // One step of the encoder, through the filter, at once.
    const double period = r.device.timing.period_s;
    const double noise = b * r.device.translation.resolution / period * (1.0 - std::exp(-w * period));
    EXPECT_LE(noise, std::max(0.05, 0.005 * r.device.translation.max_effort) * (1 + 1e-9));
  }
  EXPECT_GT(damped, 10);
}

TEST(Design, OfForceAndTorqueIsStableBetweenTheCases) {
  Random random(7);
  for (const char* kind : {"shaping_filter", "direct", "spring_damper"}) {
    DesignProblem r = sim_arm();
    r.goals.kind = kind;
    const Design d = designed(r);
    const std::vector<AxisProblem> problems = axis_problems(r);
    for (std::size_t a = 0; a < 2; ++a) {
      LoopController law = controller_of(d.spec, problems[a], arm_squared(r));
      const AxisDesign& axis = a == 0 ? d.translation : d.rotation;
      EXPECT_GT(axis.shown_stiffness, 0.0) << kind;
      const bool series = law.law == LoopController::Law::kSpringDamper;
      if (series) law.stiffness *= 1.98, law.damping *= 1.98;
      const double k = series ? 1.98 * problems[a].contact.all_points : 1.98 * axis.shown_stiffness;
      for (const LoopPlant& plant : finer_cases(problems[a], random, 300))
        ASSERT_LT(spectral_radius(plant, law, k), 1.0);
    }
  }
}

TEST(Design, IsJudgedToHoldByTheJudge) {
  Random random(99);
  int certified = 0;
  for (int i = 0; i < 40; ++i) {
    const DesignProblem r = random_request(random);
    const Design d = designed(r);
    if (d.status == DesignStatus::kInfeasible) continue;
    const Design judged = judge_coupling(r, d.spec);
    EXPECT_EQ(judged.status, DesignStatus::kAsRequested) << (judged.reasons.empty() ? "" : judged.reasons.front());
    EXPECT_EQ(judged.translation.critical_stiffness, d.translation.critical_stiffness);
    EXPECT_EQ(judged.translation.shown_stiffness, d.translation.shown_stiffness);
    ++certified;
  }
  EXPECT_GT(certified, 15);
}

TEST(Design, ReportsTheMarginThatItHas) {
  for (const DesignProblem& r : {stylus(), robot(2.0, 5.0, 50.0), robot(2.0, 10.0, 10.0)}) {
    const Design d = designed(r);
    const LoopController law = law_of_translation(r, d.spec);
    EXPECT_NEAR(d.translation.gain_margin, d.translation.critical_stiffness / d.translation.shown_stiffness, 1e-9);
    EXPECT_GE(d.translation.gain_margin, r.goals.gain_margin);
    EXPECT_LT(spectral_radius(d.translation.worst_case, law, 0.999 * d.translation.critical_stiffness), 1.0);
    EXPECT_GT(spectral_radius(d.translation.worst_case, law, 1.001 * d.translation.critical_stiffness), 1.0);
    EXPECT_NE(d.translation.worst_case_text.find("kg"), std::string::npos);
  }
}

TEST(Judge, RefusesWhatTheMarginDoesNotCover) {
  const DesignProblem r = stylus();
  CouplingSpec spec = designed(r).spec;
  spec.gain *= 1.05;
  const Design judged = judge_coupling(r, spec);
  EXPECT_EQ(judged.status, DesignStatus::kInfeasible);
  ASSERT_FALSE(judged.reasons.empty());
  EXPECT_NE(judged.reasons.front().find("margin"), std::string::npos);
  EXPECT_EQ(judged.spec.gain, spec.gain);
}

TEST(Judge, HoldsAnyPassiveHandAgainstRuleP) {
  DesignProblem r = robot(2.0, 5.0, 50.0);
  r.hand.translation.any_passive = true;
  CouplingSpec spec = designed(r).spec;
  EXPECT_EQ(judge_coupling(r, spec).status, DesignStatus::kAsRequested);
  spec.gain *= 1.03;  // which the released device alone would bear with the margin
  const Design judged = judge_coupling(r, spec);
  EXPECT_LT(judged.translation.spectral_radius, 1.0);
  EXPECT_EQ(judged.status, DesignStatus::kInfeasible);
}

TEST(Judge, RefusesThePapersFilterOnAFreeStylus) {
  CouplingSpec paper;
  paper.cutoff_hz = 5.0, paper.damping_ratio = 1.0;
  const Design judged = judge_coupling(stylus(), paper);
  EXPECT_EQ(judged.status, DesignStatus::kInfeasible);
  EXPECT_LT(judged.translation.critical_stiffness, 0.1);
}

TEST(Judge, RefusesDampingThatIsTooStrongOrTooNoisy) {
  DesignProblem r = stylus();
  CouplingSpec spec = designed(r).spec;
  spec.injected_damping_ns_per_m *= 1.2, spec.gain *= 0.5;
  const Design noisy = judge_coupling(r, spec);
  EXPECT_EQ(noisy.status, DesignStatus::kInfeasible);
  ASSERT_FALSE(noisy.reasons.empty());
  EXPECT_NE(noisy.reasons.front().find("noise"), std::string::npos);
  r.device.translation.resolution = 0.0;
  EXPECT_EQ(judge_coupling(r, spec).status, DesignStatus::kAsRequested);
  spec.injected_damping_ns_per_m = 1.01 * damping_limit(axis_problems(r)[0], spec.velocity_filter_hz);
  EXPECT_EQ(judge_coupling(r, spec).status, DesignStatus::kInfeasible);
}

TEST(Judge, RefusesMoreThanTheDeviceCanShow) {
  DesignProblem r = robot(2.0, 5.0, 50.0);
  r.contact.all_points = 400.0, r.device.translation.max_stiffness = 300.0;
  CouplingSpec spec;
  spec.cutoff_hz = 5.0;
  EXPECT_EQ(judge_coupling(r, spec).status, DesignStatus::kInfeasible);
  spec.gain = 0.75;
  EXPECT_EQ(judge_coupling(r, spec).status, DesignStatus::kAsRequested);
}

TEST(Judge, RefusesTheWordAndTheNumberThatAreNone) {
  CouplingSpec spec;
  spec.cutoff_hz = -1.0;
  EXPECT_THROW(judge_coupling(stylus(), spec), std::invalid_argument);
  spec = {};
  spec.kind = "rubber";
  EXPECT_THROW(judge_coupling(stylus(), spec), std::invalid_argument);
}

// --- Rule P.

TEST(AnyPassiveHand, GetsNoInjectedDampingAndRuleP) {
  DesignProblem r = robot(2.0, 5.0, 50.0);
  r.hand.translation.any_passive = true;
  const Design d = designed(r);
  EXPECT_EQ(d.spec.injected_damping_ns_per_m, 0.0);
  EXPECT_TRUE(d.translation.passive);
  EXPECT_LE(2.0 * d.translation.shown_stiffness,
            passive_stiffness_filter(cutoff_rad_per_s(d.spec), d.spec.damping_ratio, 50.0, r.device.timing, 3e-3) *
                (1 + 1e-9));
  r.device.translation.damping = 0.005;
  EXPECT_EQ(designed(r).spec.injected_damping_ns_per_m, 0.0);
  EXPECT_EQ(designed(r).status, DesignStatus::kInfeasible);
}

TEST(AnyPassiveHand, IsMetByTheDampingThatTheDesignAsksFor) {
  DesignProblem r = stylus();
  r.hand.translation.any_passive = true;
  const AxisDesign now = designed(r).translation;
  r.device.translation.damping = 1.001 * now.damping_required;
  EXPECT_EQ(designed(r).status, DesignStatus::kAsRequested);
  r.device.translation.damping = 0.99 * now.damping_required;
  EXPECT_NE(designed(r).status, DesignStatus::kAsRequested);
  r.device.translation.damping = 1.001 * now.damping_required_any_cutoff;
  EXPECT_EQ(designed(r).status, DesignStatus::kBandwidthRaised);
  r.device.translation.damping = 0.98 * now.damping_required_any_cutoff;
  EXPECT_EQ(designed(r).status, DesignStatus::kStiffnessReduced);
}

TEST(AnyPassiveHand, IsNeverCalledSafeBecauseOfInjectedDamping) {
  const Design d = designed(stylus());
  EXPECT_GT(d.spec.injected_damping_ns_per_m, 0.0);
  EXPECT_FALSE(d.translation.passive);
  EXPECT_EQ(d.translation.passive_stiffness, 0.0);
}

// --- Force and torque.

TEST(ForceAndTorque, ShareOneFilterAndGetTwoDampings) {
  const DesignProblem r = sim_arm();
  const Design d = designed(r);
  EXPECT_NE(d.status, DesignStatus::kInfeasible);
  EXPECT_GE(d.translation.gain_margin, 2.0);
  EXPECT_GE(d.rotation.gain_margin, 2.0);
  EXPECT_EQ(d.spec.injected_damping_nms_per_rad, d.rotation.injected_damping);
  EXPECT_TRUE(std::isfinite(d.spec.stiffness_cap_n_per_m) && std::isfinite(d.spec.stiffness_cap_nm_per_rad));
  EXPECT_NEAR(d.rotation.shown_stiffness, d.spec.gain * r.contact_rotation.all_points, 1e-9);
  EXPECT_NEAR(d.translation.shown_stiffness, d.spec.gain * r.contact.all_points, 1e-9);
}

TEST(ForceAndTorque, TheWeakerAxisSetsTheGain) {
  DesignProblem r = sim_arm();
  r.goals.allow_injected_damping = false;
  r.device.rotation.damping = 0.02;
  const Design d = designed(r);
  EXPECT_LT(d.spec.gain, 1.0);
  EXPECT_GT(d.translation.gain_margin, 2.5);
  EXPECT_NEAR(d.rotation.gain_margin, 2.0, 0.01);
  r.goals.free_cap = true;
  const Design capped = designed(r);
  EXPECT_GT(capped.translation.shown_stiffness, 1.2 * d.translation.shown_stiffness);
}

TEST(ForceAndTorque, WithoutCapsTogetherMayBeTwiceAsStiff) {
  const DesignProblem r = sim_arm();
  CouplingSpec spec = designed(r).spec;
  const Design capped = judge_coupling(r, spec);
  spec.stiffness_cap_n_per_m = spec.stiffness_cap_nm_per_rad = kInfinity;
  const Design free = judge_coupling(r, spec);
  EXPECT_NEAR(2.0 * free.translation.gain_margin, capped.translation.gain_margin, 1e-9);
  EXPECT_NEAR(2.0 * free.rotation.gain_margin, capped.rotation.gain_margin, 1e-9);
  // Where that factor comes from: one point with an arm has all of both bounds, and both at once.
  const Eigen::Vector2d along(1.0, 0.1);
  const Eigen::Matrix2d k = 100.0 * along * along.transpose();
  const Eigen::Vector2d scale(1.0 / std::sqrt(k(0, 0)), 1.0 / std::sqrt(k(1, 1)));
  const Eigen::Matrix2d relative = scale.asDiagonal() * k * scale.asDiagonal();
  EXPECT_NEAR(relative.trace(), 2.0, 1e-12);
  EXPECT_NEAR(relative.determinant(), 0.0, 1e-12);
}

TEST(ForceAndTorque, RotationOfADeviceWithoutTorqueIsNotLookedAt) {
  DesignProblem r = stylus();
  r.device.rotation.damping = std::nan("");
  r.contact_rotation = {-1.0, -1.0};
  const Design d = designed(r);
  EXPECT_EQ(d.rotation.shown_stiffness, 0.0);
  EXPECT_TRUE(d.rotation.worst_case_text.empty());
  EXPECT_TRUE(std::isinf(d.spec.stiffness_cap_nm_per_rad));
}

// --- Caps, gains, limits.

TEST(FreeCap, KeepsEachPointsOwnStiffness) {
  DesignProblem r = stylus();
  const Design scaled = designed(r);
  r.goals.free_cap = true;
  const Design capped = designed(r);
  EXPECT_EQ(capped.spec.gain, 1.0);
  EXPECT_NEAR(capped.spec.stiffness_cap_n_per_m, capped.translation.shown_stiffness, 1e-9);
  EXPECT_NEAR(capped.translation.shown_stiffness, scaled.translation.shown_stiffness, 1e-6);
  r.contact.one_point = 600.0;
  const Design point = designed(r);
  EXPECT_NEAR(point.spec.gain, point.translation.shown_stiffness / 600.0, 1e-3);
  EXPECT_NEAR(point.spec.gain * point.spec.stiffness_cap_n_per_m, point.translation.shown_stiffness, 1e-9);
}

TEST(FreeCap, IsWhatADirectCouplingNeeds) {
  DesignProblem r = stylus();
  r.goals.kind = "direct";
  const Design refused = designed(r);
  EXPECT_EQ(refused.status, DesignStatus::kInfeasible);
  EXPECT_FALSE(refused.remedies.empty());
  r.goals.free_cap = true;
  const Design capped = designed(r);
  EXPECT_EQ(capped.status, DesignStatus::kStiffnessReduced);
  EXPECT_GT(capped.translation.shown_stiffness, 250.0);
}

TEST(Design, NeverShowsMoreThanTheDeviceCan) {
  DesignProblem r = robot(2.0, 5.0, 50.0);
  r.device.translation.max_stiffness = 300.0;
  for (const char* kind : {"shaping_filter", "direct", "spring_damper", "auto"})
    for (const bool cap : {false, true}) {
      r.goals.kind = kind, r.goals.free_cap = cap;
      const Design d = designed(r);
      EXPECT_LE(d.translation.shown_stiffness, 300.0 * (1 + 1e-9)) << kind << cap;
      EXPECT_EQ(d.translation.wanted_stiffness, 300.0);
      if (std::string(kind) == "shaping_filter") {
        EXPECT_EQ(d.status, DesignStatus::kAsRequested);
      }
    }
}

TEST(Design, LeavesThePassivityControllerHalfOfWhatTheLoopBears) {
  const DesignProblem r = sim_arm();
  const Design d = designed(r);
  const std::vector<AxisProblem> problems = axis_problems(r);
  EXPECT_NEAR(d.spec.passivity_damping_limit_ns_per_m + d.spec.injected_damping_ns_per_m,
              0.5 * critical_damping(problems[0], d.spec.velocity_filter_hz), 1e-9);
  EXPECT_NEAR(d.spec.passivity_damping_limit_nms_per_rad + d.spec.injected_damping_nms_per_rad,
              0.5 * critical_damping(problems[1], d.spec.velocity_filter_hz), 1e-9);
  EXPECT_EQ(designed(stylus()).spec.passivity_damping_limit_nms_per_rad, 0.0);
}

TEST(Design, SaysHowFastOneMayApproach) {
  DesignProblem r = robot(2.0, 5.0, 50.0);
  EXPECT_EQ(designed(r).max_approach_m_per_s, 0.0);
  r.goals.force_layer_depth_m = 0.004;
  const Design d = designed(r);
  // Slowest timing, heaviest hand on the heaviest device; M/B of the released one is the shorter way to stop.
  const double tau = d.lag_s + 0.6e-3 + (2e-3 + 2.2e-3) + 3e-3;
  double stop = 0.0;
  const AxisProblem problem = axis_problems(r)[0];
  for (const DesignCase& one : problem.cases) {
    const double m = one.plant.mass + one.plant.hand_mass, b = one.plant.damping + one.plant.hand_damping;
    stop = std::max(stop, std::min(std::sqrt(m / r.contact.one_point), m / b));
  }
  EXPECT_NEAR(d.max_approach_m_per_s, 0.004 / (tau + stop), 1e-9);
  r.contact.one_point = 200.0;
  EXPECT_GE(designed(r).max_approach_m_per_s, d.max_approach_m_per_s);
}

// --- Limit cycles.

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

// --- The other kinds, and auto.

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

TEST(Auto, KeepsTheFilterUnlessAnotherShowsHalfAsMuchAgain) {
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

// --- Order.

TEST(Design, MoreDampingLessDelayAndALowerWishNeverCostMuch) {
  // A tenth is what the search gives away for gentler parameters; a level of damping is another tenth.
  constexpr double kGrid = 0.85;
  for (const char* kind : {"shaping_filter", "direct", "spring_damper"}) {
    for (const bool light : {true, false}) {
      double before = 0.0;
      for (double b = light ? 0.01 : 5.0; b < (light ? 20.0 : 100.0); b *= 2.0) {
        DesignProblem r = light ? stylus() : robot(2.0, 5.0, 1.0);
        r.device.translation.damping = b, r.goals.kind = kind, r.goals.free_cap = true;
        const double shown = designed(r).translation.shown_stiffness;
        EXPECT_GE(shown, kGrid * before) << kind << " damping " << b;
        before = std::max(before, shown);
      }
      before = 0.0;
      for (double delay = 6e-3; delay >= 0.0; delay -= 1.5e-3) {
        DesignProblem r = light ? stylus() : robot(2.0, 5.0, 10.0);
        r.device.timing.delay_s = delay, r.goals.kind = kind, r.goals.free_cap = true;
        const double shown = designed(r).translation.shown_stiffness;
        EXPECT_GE(shown, kGrid * before) << kind << " delay " << delay;
        before = std::max(before, shown);
      }
      before = 0.0;
      for (double goal = 4000.0; goal > 20.0; goal /= 2.0) {
        DesignProblem r = light ? stylus() : robot(2.0, 5.0, 10.0);
        r.contact = {goal / 20.0, goal}, r.goals.kind = kind, r.goals.free_cap = true;
        const AxisDesign d = designed(r).translation;
        EXPECT_GE(d.shown_stiffness / d.wanted_stiffness, kGrid * before) << kind << " wish " << goal;
        before = std::max(before, d.shown_stiffness / d.wanted_stiffness);
      }
    }
  }
}

TEST(Design, ReachesEveryStatusWord) {
  std::set<std::string> words;
  Random random(3);
  for (int i = 0; i < 60; ++i) words.emplace(name_of(designed(random_request(random)).status));
  EXPECT_EQ(words, (std::set<std::string>{"as_requested", "bandwidth_raised", "damping_added", "stiffness_reduced",
                                          "infeasible"}));
}

TEST(Design, SaysWhatLimitsAndWhatItWouldTake) {
  Random random(11);
  for (int i = 0; i < 40; ++i) {
    const DesignProblem r = random_request(random);
    const Design d = designed(r);
    if (d.status == DesignStatus::kAsRequested) {
      EXPECT_TRUE(d.remedies.empty());
      continue;
    }
    EXPECT_FALSE(d.reasons.empty()) << i;
    EXPECT_FALSE(d.remedies.empty()) << i;
    for (const auto* sentences : {&d.reasons, &d.remedies})
      for (const std::string& s : *sentences) EXPECT_EQ(s.back(), '.') << s;
  }
}

TEST(Design, WhatTheCapRemedySaysIsTrue) {
  DesignProblem r = stylus();
  const Design d = designed(r);
  r.contact.all_points = 0.999 * d.translation.shown_stiffness;
  const Design again = designed(r);
  EXPECT_EQ(again.spec.gain, 1.0);
  EXPECT_NE(again.status, DesignStatus::kStiffnessReduced);
}

TEST(Design, GivesTheSameBitsAgain) {
  for (const DesignProblem& r : {stylus(), sim_stylus(), sim_arm()}) {
    const Design a = designed(r), b = designed(r);
    const auto bits = [](double x) {
      std::uint64_t u;
      std::memcpy(&u, &x, sizeof u);
      return u;
    };
    EXPECT_EQ(bits(a.spec.gain), bits(b.spec.gain));
    EXPECT_EQ(bits(a.spec.injected_damping_ns_per_m), bits(b.spec.injected_damping_ns_per_m));
    EXPECT_EQ(bits(a.translation.critical_stiffness), bits(b.translation.critical_stiffness));
    EXPECT_EQ(bits(a.translation.spectral_radius), bits(b.translation.spectral_radius));
    EXPECT_EQ(bits(a.rotation.limit_cycle_bound), bits(b.rotation.limit_cycle_bound));
    EXPECT_EQ(a.reasons, b.reasons);
    EXPECT_EQ(a.remedies, b.remedies);
  }
}

TEST(Design, OfTheSimulatedDevicesIsQuickAndHolds) {
  for (DesignProblem r : {sim_stylus(), sim_arm()})
    for (const char* kind : {"shaping_filter", "spring_damper", "direct", "auto"})
      for (const bool cap : {false, true}) {
        r.goals.kind = kind, r.goals.free_cap = cap;
        const Timed t = timed(r);
        if (cap || std::string(kind) != "auto") print(r, t);
        EXPECT_LT(t.milliseconds, 2000.0);  // 20 to 100 ms on an idle machine
      }
}

// --- What cannot be designed for.

void refused(DesignProblem r, const char* word, void (*spoil)(DesignProblem&)) {
  spoil(r);
  try {
    design_coupling(r);
    ADD_FAILURE() << "accepted: " << word;
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
}

TEST(Design, RefusesNumbersThatNothingCanBeDesignedFor) {
  refused(stylus(), "damping", [](DesignProblem& r) { r.device.translation.damping = -1.0; });
  refused(stylus(), "inertia_min", [](DesignProblem& r) { r.device.translation.inertia_min = std::nan(""); });
  refused(stylus(), "period_s", [](DesignProblem& r) { r.device.timing.period_s = 0.0; });
  refused(stylus(), "mass_max", [](DesignProblem& r) { r.hand.translation.mass_max = 0.0; });
  refused(stylus(), "contact.all_points", [](DesignProblem& r) { r.contact.all_points = kInfinity; });
  refused(stylus(), "contact.one_point", [](DesignProblem& r) { r.contact.one_point = 2000.0; });
  refused(stylus(), "contact.one_point", [](DesignProblem& r) { r.contact.one_point = 1e-180; });
  refused(stylus(), "contact.all_points", [](DesignProblem& r) { r.contact.all_points = 1e180; });
  refused(sim_arm(), "contact_rotation", [](DesignProblem& r) { r.contact_rotation = {}; });
  refused(sim_arm(), "rotation", [](DesignProblem& r) { r.device.rotation.inertia_min = 0.0; });
  refused(sim_arm(), "rotation", [](DesignProblem& r) { r.hand.rotation.damping_min = -1.0; });
  refused(stylus(), "rubber", [](DesignProblem& r) { r.goals.kind = "rubber"; });
  refused(stylus(), "gain_margin", [](DesignProblem& r) { r.goals.gain_margin = 0.9; });
  refused(stylus(), "cutoff_hz", [](DesignProblem& r) { r.goals.cutoff_hz = 0.0; });
  refused(stylus(), "max_cutoff_hz", [](DesignProblem& r) { r.goals.cutoff_hz = 300.0; });
  refused(stylus(), "rate", [](DesignProblem& r) { r.goals.cutoff_hz = 600.0, r.goals.max_cutoff_hz = 1000.0; });
  refused(stylus(), "force_layer_depth_m", [](DesignProblem& r) { r.goals.force_layer_depth_m = std::nan(""); });
}

TEST(Design, OfADeviceWithoutAnyDampingThatMayBeReleasedIsInfeasibleNotANumber) {
  for (const char* kind : {"shaping_filter", "spring_damper", "direct", "auto"})
    for (const bool cap : {false, true}) {
      DesignProblem r = stylus();
      r.device.translation.damping = 0.0;
      r.goals.allow_injected_damping = false, r.goals.kind = kind, r.goals.free_cap = cap;
      const Design d = designed(r);
      EXPECT_EQ(d.status, DesignStatus::kInfeasible) << kind;
      EXPECT_EQ(d.translation.shown_stiffness, 0.0) << kind;
      EXPECT_TRUE(std::isfinite(d.spec.gain) && std::isfinite(d.spec.stiffness_n_per_m));
      EXPECT_FALSE(d.reasons.empty());
    }
}

// --- The search's table.

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
      law.injected_damping = random.uniform(0.0, 0.5) * critical_damping(axis_problems(r)[0], 100.0);
    if (law.w0_rad_per_s * slowest(r.device.timing).period_s > 0.7) continue;
    LoopTable table(cases, {100.0});
    table.use([&](const Phasor& at, double period) {
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

}  // namespace designer_test
}  // namespace voxtouch::coupling::design
