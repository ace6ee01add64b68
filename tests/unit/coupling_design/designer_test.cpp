#include "core/coupling/design/designer.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <stdexcept>

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
  out.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

void print(const DesignProblem& r, const Timed& t) {
  const Design& d = t.design;
  std::printf(
      "%s: %s, %s, %.3g Hz, d %.3g, K %.3g, c %.4g N/m, r %.3g Ns/m, cap %.4g N/m %.4g Nm/rad, B "
      "%.3g Ns/m %.3g "
      "Nms/rad "
      "at %g Hz, lag %.3g ms, approach %.3g m/s [%.1f ms]\n",
      r.device.name.c_str(), std::string(name_of(d.status)).c_str(), d.spec.kind.c_str(),
      d.spec.cutoff_hz, d.spec.damping_ratio, d.spec.gain, d.spec.stiffness_n_per_m,
      d.spec.damping_ns_per_m, d.spec.stiffness_cap_n_per_m, d.spec.stiffness_cap_nm_per_rad,
      d.spec.injected_damping_ns_per_m, d.spec.injected_damping_nms_per_rad,
      d.spec.velocity_filter_hz, 1e3 * d.lag_s, d.max_approach_m_per_s, t.milliseconds);
  for (const AxisDesign* a : {&d.translation, &d.rotation})
    if (a->requested_stiffness > 0.0)
      std::printf(
          "  shown %.4g of %.4g, critical %.4g, margin %.4g, %s, passive up to %.4g, limit cycle "
          "%.3g, damping required %.3g\n",
          a->displayed_stiffness, a->requested_stiffness, a->critical_stiffness, a->gain_margin,
          a->passive ? "passive" : "not passive", a->passive_stiffness, a->limit_cycle_bound,
          a->damping_required);
  for (const DesignReason& reason : d.reasons)
    std::printf("  - limit %d, axis %zu\n", static_cast<int>(reason.what), reason.axis);
}

// --- Certificates, checked independently.

/// Cases between the corners, and timings between nominal and slowest, that the designer has not
/// evaluated.
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
    const bool alone =
        hand.any_passive ? random.chance(0.2) : hand.may_release && random.chance(0.3);
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

TEST(Design, IsStableBetweenTheEvaluatedCases) {
  Random random(20240517);
  std::map<std::string, int> statuses;
  int loops = 0;
  for (int i = 0; i < 80; ++i) {
    DesignProblem r = random_request(random);
    r.goals.velocity_windows = i % 2 > 0;
    const Timed t = timed(r);
    ++statuses[std::string(name_of(t.design.status)) + " " + t.design.spec.kind];
    if (t.design.translation.displayed_stiffness == 0.0)
      continue;
    const AxisProblem problem = axis_problems(r)[0];
    const LoopController law = law_of_translation(r, t.design.spec);
    const bool series = law.law == LoopController::Law::kSpringDamper;
    for (const LoopPlant& plant : finer_cases(problem, random, 40))
      for (const double fraction : {0.001, 0.1, 1.0, 0.99 * r.goals.gain_margin}) {
        LoopController scaled = law;
        if (series)
          scaled.stiffness *= fraction, scaled.damping *= fraction;
        const double k = series ? fraction * r.contact.all_points
                                : fraction * t.design.translation.displayed_stiffness;
        ++loops;
        ASSERT_LT(spectral_radius(plant, scaled, k), 1.0)
            << "request " << i << " " << t.design.spec.kind << " share " << fraction << " m "
            << plant.mass << "+" << plant.hand_mass << " b_h " << plant.hand_damping << " k_h "
            << plant.hand_stiffness << " T " << plant.period_s;
      }
  }
  for (const auto& [word, count] : statuses)
    std::printf("%4d %s\n", count, word.c_str());
  std::printf("%d loops\n", loops);
}

/// To a percent, which the tables that are searched are good to.
TEST(Design, VelocityWindowsNeverReduceStiffness) {
  Random random(43);
  int windows = 0;
  double most = 0.0;
  for (int i = 0; i < 60; ++i) {
    DesignProblem r = random_request(random);
    r.goals.kind = i % 2 ? "shaping_filter" : "direct";
    if (i % 2 == 0)
      r.goals.free_cap = true;
    const Design without = designed(r);
    EXPECT_EQ(without.spec.velocity_window, 0U) << i;
    r.goals.velocity_windows = true;
    const Design with = designed(r);
    EXPECT_GE(with.translation.displayed_stiffness, 0.985 * without.translation.displayed_stiffness)
        << i;
    if (with.spec.velocity_window > 0)
      ++windows, most = std::max(most, with.translation.displayed_stiffness /
                                           without.translation.displayed_stiffness);
  }
  std::printf("%d designs on windows, up to %.2f times the stiffness\n", windows, most);
  EXPECT_GT(windows, 10);
}

TEST(Design, InjectsNoMoreThanTheInnerLoopAndTheNoiseAllow) {
  Random random(41);
  int damped = 0;
  for (int i = 0; i < 60; ++i) {
    DesignProblem r = random_request(random);
    r.goals.velocity_windows = i % 2 > 0;
    const Design d = designed(r);
    const VelocityEstimate velocity = velocity_of(d.spec);
    const double b = d.spec.injected_damping_ns_per_m, w = velocity.filter_rad_per_s();
    if (b == 0.0)
      continue;
    ++damped;
    EXPECT_TRUE(r.goals.allow_injected_damping);
    for (const LoopPlant& plant : finer_cases(axis_problems(r)[0], random, 30))
      ASSERT_LE(b, 0.501 * inner_limit(plant, w, velocity.window).damping) << i;
    // One step of the encoder, through the filter, at once; or the possible sum of steps in a
    // window.
    const double period = r.device.timing.period_s;
    const double fraction =
        velocity.window > 0 ? window_step_ratio(velocity.window) : 1.0 - std::exp(-w * period);
    const double noise = b * r.device.translation.resolution / period * fraction;
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
      EXPECT_GT(axis.displayed_stiffness, 0.0) << kind;
      const bool series = law.law == LoopController::Law::kSpringDamper;
      if (series)
        law.stiffness *= 1.98, law.damping *= 1.98;
      const double k =
          series ? 1.98 * problems[a].contact.all_points : 1.98 * axis.displayed_stiffness;
      for (const LoopPlant& plant : finer_cases(problems[a], random, 300))
        ASSERT_LT(spectral_radius(plant, law, k), 1.0);
    }
  }
}

TEST(Design, PassesItsOwnEvaluation) {
  Random random(99);
  int certified = 0;
  for (int i = 0; i < 40; ++i) {
    const DesignProblem r = random_request(random);
    const Design d = designed(r);
    if (d.status == DesignStatus::kInfeasible)
      continue;
    const Design judged = judge_coupling(r, d.spec);
    EXPECT_EQ(judged.status, DesignStatus::kAsRequested) << i;
    EXPECT_EQ(judged.translation.critical_stiffness, d.translation.critical_stiffness);
    EXPECT_EQ(judged.translation.displayed_stiffness, d.translation.displayed_stiffness);
    ++certified;
  }
  EXPECT_GT(certified, 15);
}

TEST(Design, ReportsTheMarginThatItHas) {
  for (const DesignProblem& r : {stylus(), robot(2.0, 5.0, 50.0), robot(2.0, 10.0, 10.0)}) {
    const Design d = designed(r);
    const LoopController law = law_of_translation(r, d.spec);
    EXPECT_NEAR(d.translation.gain_margin,
                d.translation.critical_stiffness / d.translation.displayed_stiffness, 1e-9);
    EXPECT_GE(d.translation.gain_margin, r.goals.gain_margin);
    EXPECT_LT(spectral_radius(d.translation.worst_case.plant, law,
                              0.999 * d.translation.critical_stiffness),
              1.0);
    EXPECT_GT(spectral_radius(d.translation.worst_case.plant, law,
                              1.001 * d.translation.critical_stiffness),
              1.0);
  }
}

// --- Order.

TEST(Design, MoreDampingAndLessDelayNeverCostMuch) {
  // The search gives up a tenth for gentler parameters; a level of damping is another tenth.
  constexpr double kGrid = 0.85;
  for (const char* kind : {"shaping_filter", "direct", "spring_damper"}) {
    for (const bool light : {true, false}) {
      double before = 0.0;
      for (double b = light ? 0.01 : 5.0; b < (light ? 20.0 : 100.0); b *= 2.0) {
        DesignProblem r = light ? stylus() : robot(2.0, 5.0, 1.0);
        r.device.translation.damping = b, r.goals.kind = kind, r.goals.free_cap = true;
        const double displayed = designed(r).translation.displayed_stiffness;
        EXPECT_GE(displayed, kGrid * before) << kind << " damping " << b;
        before = std::max(before, displayed);
      }
      before = 0.0;
      for (double delay = 6e-3; delay >= 0.0; delay -= 1.5e-3) {
        DesignProblem r = light ? stylus() : robot(2.0, 5.0, 10.0);
        r.device.timing.delay_s = delay, r.goals.kind = kind, r.goals.free_cap = true;
        const double displayed = designed(r).translation.displayed_stiffness;
        EXPECT_GE(displayed, kGrid * before) << kind << " delay " << delay;
        before = std::max(before, displayed);
      }
      before = 0.0;
      for (double goal = 4000.0; goal > 20.0; goal /= 2.0) {
        DesignProblem r = light ? stylus() : robot(2.0, 5.0, 10.0);
        r.contact = {goal / 20.0, goal}, r.goals.kind = kind, r.goals.free_cap = true;
        const AxisDesign d = designed(r).translation;
        EXPECT_GE(d.displayed_stiffness / d.requested_stiffness, kGrid * before)
            << kind << " requested " << goal;
        before = std::max(before, d.displayed_stiffness / d.requested_stiffness);
      }
    }
  }
}

TEST(Design, ReachesEveryStatusWord) {
  std::set<std::string> words;
  Random random(3);
  for (int i = 0; i < 60; ++i)
    words.emplace(name_of(designed(random_request(random)).status));
  EXPECT_EQ(words, (std::set<std::string>{"as_requested", "bandwidth_raised", "damping_added",
                                          "stiffness_reduced", "infeasible"}));
}

TEST(Design, ReportsWhatLimitsIt) {
  Random random(11);
  for (int i = 0; i < 40; ++i) {
    const Design d = designed(random_request(random));
    EXPECT_TRUE(d.status == DesignStatus::kAsRequested || !d.reasons.empty()) << i;
  }
}

TEST(Design, ShowsAContactCappedAtItsStiffnessInFull) {
  DesignProblem r = stylus();
  const Design d = designed(r);
  r.contact.all_points = 0.999 * d.translation.displayed_stiffness;
  const Design again = designed(r);
  EXPECT_EQ(again.spec.gain, 1.0);
  EXPECT_NE(again.status, DesignStatus::kStiffnessReduced);
}

TEST(Design, RepeatsBitIdentically) {
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
  }
}

TEST(Design, OfTheSimulatedDevicesIsFastAndStable) {
  for (DesignProblem r : {sim_stylus(), sim_arm()})
    for (const char* kind : {"shaping_filter", "spring_damper", "direct", "auto"})
      for (const bool cap : {false, true}) {
        r.goals.kind = kind, r.goals.free_cap = cap;
        const Timed t = timed(r);
        if (cap || std::string(kind) != "auto")
          print(r, t);
        EXPECT_LT(t.milliseconds, 2000.0);  // 20 to 100 ms on an idle machine
      }
}

// --- Infeasible requests.

void refused(DesignProblem r, const char* word, void (*spoil)(DesignProblem&)) {
  spoil(r);
  try {
    design_coupling(r);
    ADD_FAILURE() << "accepted: " << word;
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
}

TEST(Design, RefusesInvalidNumbers) {
  refused(stylus(), "damping", [](DesignProblem& r) { r.device.translation.damping = -1.0; });
  refused(stylus(), "inertia_min",
          [](DesignProblem& r) { r.device.translation.inertia_min = std::nan(""); });
  refused(stylus(), "period_s", [](DesignProblem& r) { r.device.timing.period_s = 0.0; });
  refused(stylus(), "mass_max", [](DesignProblem& r) { r.hand.translation.mass_max = 0.0; });
  refused(stylus(), "translation.damping",
          [](DesignProblem& r) { r.device.translation.damping = 1e12; });
  refused(stylus(), "translation.stiffness_max", [](DesignProblem& r) {
    r.hand.translation.any_passive = false, r.hand.translation.stiffness_max = 1e12,
    r.device.translation.inertia_min = 1e-9;
  });
  refused(stylus(), "longest delay",
          [](DesignProblem& r) { r.device.timing.consecutive_losses = 1000; });
  refused(stylus(), "contact.all_points",
          [](DesignProblem& r) { r.contact.all_points = kInfinity; });
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
  refused(stylus(), "rate",
          [](DesignProblem& r) { r.goals.cutoff_hz = 600.0, r.goals.max_cutoff_hz = 1000.0; });
  refused(stylus(), "force_layer_depth_m",
          [](DesignProblem& r) { r.goals.force_layer_depth_m = std::nan(""); });
}

/// A released device without friction bounces by twice the force of an encoder step.
TEST(Design, EncoderStepIsQuietOnAReleasedDeviceWithoutFriction) {
  for (const char* kind : {"shaping_filter", "direct"})
    for (const double friction : {0.0, 0.002, 0.2})
      for (const bool released : {true, false}) {
        DesignProblem r = sim_stylus();
        r.goals = {}, r.goals.kind = kind, r.goals.free_cap = true;
        r.contact = {1.0, 1e8};
        AxisModel& t = r.device.translation;
        t.coulomb_friction = friction, t.resolution = 1e-4, t.max_effort = 40.0;
        t.max_stiffness = 8000.0;
        r.hand.translation.may_release = released;
        const Design d = design_coupling(r);
        ASSERT_NE(d.status, DesignStatus::kInfeasible) << kind << friction << released;
        const AxisProblem p = axis_problems(r)[0];
        const double step_n = d.translation.displayed_stiffness * t.resolution +
                              d.spec.injected_damping_ns_per_m * step_speed(p, velocity_of(d.spec));
        const bool bounces = has_reason(d, DesignLimit::kEncoderStep);
        if (released && friction < 0.1) {
          EXPECT_LE(step_n, 0.1 + 10.0 * friction + 1e-9) << kind << friction;
          EXPECT_TRUE(bounces) << step_n;
        } else {
          EXPECT_GT(step_n, 0.13) << kind << friction << released;
          EXPECT_FALSE(bounces) << kind << friction << released;
        }
      }
}

TEST(Design, ReleasedUndampedDeviceIsInfeasible) {
  for (const char* kind : {"shaping_filter", "spring_damper", "direct", "auto"})
    for (const bool cap : {false, true}) {
      DesignProblem r = stylus();
      r.device.translation.damping = 0.0;
      r.goals.allow_injected_damping = false, r.goals.kind = kind, r.goals.free_cap = cap;
      const Design d = designed(r);
      EXPECT_EQ(d.status, DesignStatus::kInfeasible) << kind;
      EXPECT_EQ(d.translation.displayed_stiffness, 0.0) << kind;
      EXPECT_TRUE(std::isfinite(d.spec.gain) && std::isfinite(d.spec.stiffness_n_per_m));
      EXPECT_FALSE(d.reasons.empty());
    }
}

}  // namespace designer_test
}  // namespace voxtouch::coupling::design
