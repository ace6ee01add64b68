// The slow velocity estimate for small movements: when it is used, what it preserves, and its
// effect on a simulated arm.
#include <gtest/gtest.h>

#include "core/coupling/design/filter_search.hpp"
#include "core/coupling/design/loop_response.hpp"
#include "core/coupling/design/min_damping_ratio.hpp"
#include "core/coupling/design/slow_velocity.hpp"
#include "tests/support/coupling_models/nonlinear_loop.hpp"
#include "tests/support/coupling_models/population.hpp"
#include "tests/unit/coupling_design/designer_support.hpp"

namespace voxtouch::testing {
namespace {

using namespace coupling;
using namespace coupling::design;

DesignProblem arm() {
  DesignProblem r = sim_arm();
  r.goals = {};
  r.goals.force_layer_depth_m = 0.004;
  return r;
}

AxisProblem judged_by(const DesignProblem& request, const Design& d) {
  std::vector<AxisProblem> problems = axis_problems(request);
  set_min_damping(request, problems);
  problems[0].damping_force_ratio = d.spec.damping_force_ratio;
  return problems[0];
}

bool keeps(const DesignProblem& request, const Design& d, double hz, double fraction) {
  AxisProblem translation = judged_by(request, d);
  LoopController law = controller_of(d.spec, translation, 0.0);
  law.use({hz, 0});
  for (DesignCase& one : translation.cases)
    one.least_damping_ratio *= fraction;
  const double displayed =
      displayed_stiffness(request, axis_problems(request), d.spec)[0].coupling *
      d.translation.displayed_stiffness;
  return critical_case(translation, law).stiffness >= fraction * translation.margin * displayed &&
         meets_min_damping(translation, law, d.translation.displayed_stiffness);
}

/// The slowest that keeps three quarters of margin and minimum damping ratios, while the velocity
/// that large movements are damped on keeps all of both.
TEST(SlowVelocity, IsTheSlowestThatKeepsThreeQuarters) {
  const DesignProblem request = arm();
  const Design d = design_coupling(request);
  ASSERT_GT(d.spec.slow_velocity_hz, 0.0);
  const AxisProblem translation = judged_by(request, d);
  EXPECT_DOUBLE_EQ(d.spec.velocity_band_m_per_s, step_speed(translation, velocity_of(d.spec)));
  EXPECT_TRUE(keeps(request, d, d.spec.slow_velocity_hz, kLargeSwing));
  EXPECT_FALSE(keeps(request, d, 0.79 * d.spec.slow_velocity_hz, kLargeSwing))
      << "the next one down the list";
  EXPECT_LT(step_speed(translation, {d.spec.slow_velocity_hz, 0}),
            0.6 * d.spec.velocity_band_m_per_s);
}

TEST(SlowVelocity, IsSetOnlyIfAnEncoderStepIsPerceptible) {
  EXPECT_EQ(design_coupling(sim_stylus()).spec.slow_velocity_hz, 0.0) << "0.05 N";
  DesignProblem passive = arm(), fine = arm(), series = arm();
  passive.hand.translation.any_passive = passive.hand.rotation.any_passive = true;
  fine.device.translation.resolution = 1e-7;
  series.goals.kind = "spring_damper";
  for (const DesignProblem& request : {passive, fine, series}) {
    const Design d = design_coupling(request);
    EXPECT_EQ(d.spec.slow_velocity_hz, 0.0) << d.spec.kind;
    EXPECT_EQ(d.spec.velocity_band_m_per_s, 0.0);
  }
}

/// A slow velocity set by another program is checked too, and a band wider than the encoder's steps
/// is refused.
TEST(SlowVelocity, UnstableOneIsRefused) {
  const DesignProblem request = arm();
  const Design d = design_coupling(request);
  EXPECT_EQ(judge_coupling(request, d.spec).status, DesignStatus::kAsRequested);
  CouplingSpec slower = d.spec, wider = d.spec;
  slower.slow_velocity_hz = 2.0;
  // Of the stiffness at three quarters of the margin: the part with the slow velocity, and the
  // larger part with the other.
  for (wider.velocity_band_m_per_s *= 2.0;
       wider.slow_velocity_hz > 1.0 &&
       judge_coupling(request, wider).status == DesignStatus::kAsRequested;)
    wider.slow_velocity_hz *= 0.9;
  for (const CouplingSpec& bad : {slower, wider}) {
    const Design judged = judge_coupling(request, bad);
    EXPECT_EQ(judged.status, DesignStatus::kInfeasible);
    ASSERT_EQ(judged.reasons.size(), 1U);
    EXPECT_EQ(judged.reasons[0].what, DesignLimit::kSlowVelocity);
  }
  CouplingSpec series = d.spec;
  series.kind = "spring_damper";
  EXPECT_TRUE(has_reason(judge_coupling(request, series), DesignLimit::kSlowVelocity));
  CouplingSpec narrow = wider;
  narrow.velocity_band_m_per_s = d.spec.velocity_band_m_per_s;
  EXPECT_EQ(judge_coupling(request, narrow).status, DesignStatus::kAsRequested)
      << "three quarters of the margin are enough there";
}

/// Within the band and beyond it the damper is a mean of the two velocities, D = (1 - n) D_v + n
/// D_u of the loop's equation, 0 <= n <= 1. Both ends are stable, so all between are if no D is
/// zero on the unit circle: the segment between the ends avoids the origin at every frequency. Here
/// at nine tenths of the stiffness at which the ends are stable.
double least_between(const LoopPlant& plant, const LoopController& law, double slow_hz,
                     double stiffness) {
  const SampledPlant sampled = sample_plant(plant);
  const VelocityResponse fast(plant.period_s, law.velocity_filter_rad_per_s, law.velocity_window),
      slow(plant.period_s, VelocityEstimate{slow_hz}.filter_rad_per_s());
  double least = kInfinity;
  for (double angle = 1e-4; angle < std::numbers::pi; angle *= 1.005) {
    const Phasor at(angle);
    const Complex g = plant_response(sampled, at);
    const Complex law_of_k =
        law.law == LoopController::Law::kShapingFilter
            ? filter_response(0.5 * law.w0_rad_per_s * plant.period_s, law.damping_ratio, at)
            : Complex(1.0);
    const Complex rest = 1.0 + stiffness * g * law_of_k,
                  one = rest + law.injected_damping * g * fast(at),
                  displacement = law.injected_damping * g * (slow(at) - fast(at));
    const double n = std::clamp(
        -(one * std::conj(displacement)).real() / std::max(std::norm(displacement), 1e-300), 0.0,
        1.0);
    least = std::min(least, std::abs(one + n * displacement) / std::max(1.0, std::abs(rest - 1.0)));
  }
  return least;
}

TEST(SlowVelocity, HoldsBetweenTheTwoVelocitiesToo) {
  int designs = 0, cases = 0;
  double least = kInfinity;
  for (std::uint64_t index = 0; index < 40; ++index) {
    const coupling_models::PopulationMember member = coupling_models::draw_member(3, index);
    if (member.hand.any_passive)
      continue;
    DesignProblem request;
    request.device = member.device, request.hand.translation = member.hand,
    request.contact = member.contact;
    const Design d = design_coupling(request);
    if (!(d.spec.slow_velocity_hz > 0.0))
      continue;
    ++designs;
    const AxisProblem translation = axis_problems(request)[0];
    const LoopController law = controller_of(d.spec, translation, 0.0);
    for (const DesignCase& one : translation.cases) {
      ++cases;
      least = std::min(least, least_between(one.plant, law, d.spec.slow_velocity_hz,
                                            0.9 * kLargeSwing * translation.margin *
                                                d.translation.displayed_stiffness));
    }
  }
  std::printf(
      "%d designs with a slow velocity, %d cases: the loop's equation is %.3f from zero at least\n",
      designs, cases, least);
  EXPECT_GT(designs, 8);
  EXPECT_GT(least, 0.03);
}

/// The passivity controller may add half of what the loop tolerates on the fast velocity. On a
/// slower one of first order it tolerates more.
TEST(SlowVelocity, BearsWhatThePassivityControllerMayAdd) {
  for (const DesignProblem& request : {arm(), sim_arm(), sim_stylus()}) {
    const AxisProblem translation = axis_problems(request)[0];
    for (const VelocityEstimate& fast : kVelocityEstimates)
      for (const double hz : {8.0, 16.0, 32.0, 50.0})
        EXPECT_GT(critical_damping(translation, {hz, 0}), 0.5 * critical_damping(translation, fast))
            << request.device.name << " " << hz;
  }
}

/// The residual motion of the encoder's steps at rest includes the band's effort.
TEST(SlowVelocity, CountsInTheLimitCycle) {
  DesignProblem request = arm();
  request.device.translation.coulomb_friction = 0.0;
  const Design d = design_coupling(request);
  ASSERT_GT(d.spec.slow_velocity_hz, 0.0);
  CouplingSpec without = d.spec;
  without.slow_velocity_hz = 0.0;
  EXPECT_GT(judge_coupling(request, d.spec).translation.limit_cycle_bound,
            1.1 * judge_coupling(request, without).translation.limit_cycle_bound);
}

/// A simulated arm at rest on its encoder's steps: the damper's answer to them is at most a third,
/// and the arm stays within the reported bound.
TEST(SlowVelocity, QuietensASimulatedArm) {
  DesignProblem request = arm();
  request.device.translation.coulomb_friction = 0.0;
  const Design d = design_coupling(request);
  coupling_models::NonlinearLoop loop;
  loop.controller = controller_of(d.spec, axis_problems(request)[0], 0.0);
  loop.controller.gain = d.spec.gain;
  loop.contact_stiffness = d.spec.stiffness_cap_n_per_m;
  loop.damping_only_in_contact = true, loop.damping_fraction = d.spec.damping_force_ratio,
  loop.damping_free = d.spec.damping_force_offset_n;
  loop.resolution = request.device.translation.resolution;
  loop.push = 3.0, loop.start_speed = 0.05, loop.duration_s = 6.0;
  for (const LoopPlant& plant : {d.translation.worst_case.plant, LoopPlant{.mass = 6.0,
                                                                 .damping = 30.0,
                                                                 .hand_mass = 2.0,
                                                                 .hand_damping = 3.0,
                                                                 .hand_stiffness = 50.0,
                                                                 .delay_s = 2e-3,
                                                                 .effort_lag_s = 3e-3}}) {
    loop.plant = plant;
    loop.slow_velocity_rad_per_s = loop.velocity_band = 0.0;
    const coupling_models::NonlinearVerdict loud = coupling_models::simulate(loop);
    loop.slow_velocity_rad_per_s = 2.0 * std::numbers::pi * d.spec.slow_velocity_hz,
    loop.velocity_band = d.spec.velocity_band_m_per_s;
    const coupling_models::NonlinearVerdict quiet = coupling_models::simulate(loop);
    EXPECT_TRUE(loud.stable && quiet.stable);
    EXPECT_LE(quiet.late_effort, std::max(0.7 * loud.late_effort, 0.1)) << plant.mass;
    EXPECT_LE(quiet.late_amplitude, d.translation.limit_cycle_bound) << plant.mass;
  }
}

}  // namespace
}  // namespace voxtouch::testing
