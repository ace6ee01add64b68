#include "core/coupling/design/design_axis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "core/coupling/design/certificates.hpp"
#include "core/coupling/design/loop_response.hpp"

namespace voxtouch::coupling::design {
namespace {

using Law = LoopController::Law;

/// Below it the result is infeasible.
constexpr double kUsefulNPerM = 50.0, kUsefulNmPerRad = 0.05;
/// Fraction of a strong device's force that is barely perceptible as noise.
constexpr double kQuietRatio = 0.005;
/// Ratio of torque to force [m] if the limits of the device do not define it.
constexpr double kHandsArm = 0.05;
/// A released device without friction bounces by twice the effort of an encoder step. Twice this
/// force is at the limit of perception; friction ends larger bounces.
constexpr double kReleasedStepN = 0.1, kStepsOfFriction = 10.0;

double noise_limit(const DesignProblem& request, bool rotation) {
  const double force = request.device.translation.max_effort,
               torque = request.device.rotation.max_effort;
  const double of_force = std::max(kQuietForceN, std::isfinite(force) ? kQuietRatio * force : 0.0);
  if (!rotation)
    return of_force;
  // A torque may be as noisy as a force, relative to the range of the device.
  return of_force * (std::isfinite(force) && std::isfinite(torque) ? torque / force : kHandsArm);
}

AxisProblem problem(const DesignProblem& request, bool rotation) {
  AxisProblem out;
  out.axis = rotation ? 1 : 0;
  out.model = rotation ? request.device.rotation : request.device.translation;
  out.timing = request.device.timing;
  out.hand = rotation ? request.hand.rotation : request.hand.translation;
  out.contact = rotation ? request.contact_rotation : request.contact;
  out.cases = design_cases(out.model, out.timing, out.hand);
  out.margin = request.goals.gain_margin;
  out.requested = std::min(out.contact.all_points, out.model.max_stiffness);
  out.useful = rotation ? kUsefulNmPerRad : kUsefulNPerM;
  out.noise_limit = noise_limit(request, rotation);
  if (!rotation && (out.hand.may_release || out.hand.any_passive))
    out.step_limit = kReleasedStepN + kStepsOfFriction * out.model.coulomb_friction;
  out.large_swing = std::max(kLargeSwing, 1.0 / out.margin);
  out.damping_force_ratio =
      rotation ? 0.0 : request.goals.damping_force_ratio.value_or(kDefaultDampingForceRatio);
  return out;
}

/// Upper bound of a late, filtered difference relative to the true speed, in the mean square. The
/// average of a short period may be held for a long one. For a weighted sum of differences it is
/// multiplied by the sum of the absolute weights (Young's inequality).
double stretch(const LoopTiming& timing, int velocity_window) {
  if (timing.jitter >= 1.0)
    return kInfinity;
  const double held =
      std::sqrt((1.0 + timing.consecutive_losses) * (1.0 + timing.jitter) / (1.0 - timing.jitter));
  return velocity_window > 0 ? kWindowGain * held : held;
}

/// K k at which the loop becomes unstable, with the full injected damping or, if that is bounded,
/// with its remaining parts.
double critical_for(const AxisProblem& problem, const DesignCase& one, const LoopController& law) {
  const LoopPlant& plant = one.plant;
  const InnerLimit inner =
      law.injected_damping > 0.0
          ? one.inner->of(plant, law.velocity_filter_rad_per_s, law.velocity_window)
          : InnerLimit{};
  double least = critical_stiffness(plant, law, inner).stiffness;
  if (!(problem.damping_force_ratio > 0.0 && law.injected_damping > 0.0))
    return least;
  const LoopResponse whole(plant, law);
  LoopController less = law;
  for (const DamperPart& part : kDamperParts) {
    less.injected_damping = part.part * law.injected_damping;
    const CriticalStiffness here = critical_stiffness(plant, less, inner);
    const double counts = here.stiffness / problem.large_swing;
    if (counts < least &&
        whole.residual_damping(here.stiffness, problem.damping_force_ratio,
                               Phasor(here.frequency_rad_per_s * plant.period_s)) <= part.up_to)
      least = counts;
  }
  return least;
}

bool stable_for_all(const AxisProblem& problem, const LoopController& law, double scale,
                    double contact, std::size_t& worst) {
  LoopController scaled = law;
  scaled.stiffness *= scale, scaled.damping *= scale;
  for (std::size_t i = 0; i < problem.cases.size(); ++i) {
    const double here = critical_stiffness(problem.cases[i].plant, scaled).stiffness;
    if (!(std::isinf(here) || here > scale * contact))
      return worst = i, false;
  }
  return true;
}

}  // namespace

std::vector<AxisProblem> axis_problems(const DesignProblem& request) {
  std::vector<AxisProblem> axes{problem(request, false)};
  if (request.device.gives_torque)
    axes.push_back(problem(request, true));
  double gain = 1.0;  // the largest displayed stiffness of one common gain that exceeds the
                      // device's limit on no axis
  for (const AxisProblem& axis : axes)
    gain = std::min(gain, axis.requested / axis.contact.all_points);
  for (AxisProblem& axis : axes)
    axis.target = request.goals.free_cap ? axis.requested
                                         : std::min(axis.requested, gain * axis.contact.all_points);
  if (axes.size() > 1) {
    const double of_force = axes[1].model.damping,
                 of_torque = arm_squared(request) * axes[0].model.damping;
    const double both = of_force + of_torque;
    axes[0].series_ratio = both > 0.0 ? of_force / both : 0.0;
    axes[1].series_ratio = both > 0.0 ? of_torque / both : 0.0;
  }
  return axes;
}

double arm_squared(const DesignProblem& request) {
  if (!request.device.gives_torque)
    return 0.0;
  return request.contact_rotation.all_points / request.contact.all_points;
}

LoopController controller_of(const CouplingSpec& spec, const AxisProblem& problem,
                             double arm_squared_m2) {
  const bool rotation = problem.axis == 1;
  LoopController law;
  law.law = spec.kind == "direct"          ? Law::kDirect
            : spec.kind == "spring_damper" ? Law::kSpringDamper
                                           : Law::kShapingFilter;
  law.w0_rad_per_s = cutoff_rad_per_s(spec);
  law.damping_ratio = spec.damping_ratio;
  law.gain = 1.0;
  law.stiffness = spec.stiffness_n_per_m * (rotation ? arm_squared_m2 : 1.0);
  law.damping = spec.damping_ns_per_m * (rotation ? arm_squared_m2 : 1.0);
  law.injected_damping =
      rotation ? spec.injected_damping_nms_per_rad : spec.injected_damping_ns_per_m;
  law.use(velocity_of(spec));
  return law;
}

double step_ratio(double velocity_filter_rad_per_s, int velocity_window, double period_s) {
  return velocity_window > 0 ? window_step_ratio(velocity_window)
                             : 1.0 - std::exp(-velocity_filter_rad_per_s * period_s);
}

double critical_damping(const AxisProblem& problem, const VelocityEstimate& velocity) {
  double least = kInfinity;
  for (const DesignCase& one : problem.cases)
    least = std::min(
        least, one.inner->of(one.plant, velocity.filter_rad_per_s(), velocity.window).damping);
  return least;
}

double step_speed(const AxisProblem& problem, const VelocityEstimate& velocity) {
  return problem.model.resolution / problem.timing.period_s *
         step_ratio(velocity.filter_rad_per_s(), velocity.window, problem.timing.period_s);
}

double damping_limit(const AxisProblem& problem, const VelocityEstimate& velocity) {
  const double stable = 0.5 * critical_damping(problem, velocity),
               speed = step_speed(problem, velocity);
  return speed > 0.0 ? std::min({stable, problem.noise_limit / speed, problem.step_limit / speed})
                     : stable;
}

bool may_bounce(const AxisProblem& problem) {
  return problem.requested * problem.model.resolution + problem.noise_limit > problem.step_limit;
}

double quiet_stiffness(const AxisProblem& problem, const LoopController& law) {
  if (!(problem.model.resolution > 0.0) || std::isinf(problem.step_limit))
    return kInfinity;
  const double speed =
      problem.model.resolution / problem.timing.period_s *
      step_ratio(law.velocity_filter_rad_per_s, law.velocity_window, problem.timing.period_s);
  return std::max(0.0, problem.step_limit - law.injected_damping * speed) /
         problem.model.resolution;
}

WorstCase critical_case(const AxisProblem& problem, const LoopController& law, double enough) {
  WorstCase worst{kInfinity, 0};
  for (std::size_t i = 0; i < problem.cases.size(); ++i) {
    const double here = critical_for(problem, problem.cases[i], law);
    if (here < worst.stiffness)
      worst = {here, i};
    if (worst.stiffness < enough)
      break;
  }
  return worst;
}

WorstCase critical_scale(const AxisProblem& problem, const LoopController& law,
                         double contact_stiffness) {
  std::size_t worst = 0;
  double low = 0.0, high = 1.0;
  while (high < 1e6 && stable_for_all(problem, law, high, contact_stiffness, worst))
    low = high, high *= 2.0;
  if (high >= 1e6)
    return {kInfinity, worst};
  if (low == 0.0) {
    low = high / 1024.0;
    if (!stable_for_all(problem, law, low, contact_stiffness, worst))
      return {0.0, worst};
  }
  while (high - low > 1e-3 * high) {
    const double middle = 0.5 * (low + high);
    (stable_for_all(problem, law, middle, contact_stiffness, worst) ? low : high) = middle;
  }
  return {low, worst};
}

int whole_delay(const LoopTiming& timing, double effort_lag_s) {
  return static_cast<int>(std::ceil((timing.delay_s + effort_lag_s) / timing.period_s - 1e-9));
}

double passive_limit(const AxisProblem& problem, const LoopController& law) {
  const double lag = effort_lag_s(problem.model);
  const LoopTiming slow = slowest(problem.timing);
  const double lost = law.injected_damping > 0.0
                          ? law.injected_damping * stretch(problem.timing, law.velocity_window)
                          : 0.0;
  const double damping = std::max(0.0, problem.model.damping - lost);
  switch (law.law) {
    case Law::kShapingFilter: {
      const double jittered = passive_stiffness_filter(law.w0_rad_per_s, law.damping_ratio, damping,
                                                       problem.timing, lag);
      if (problem.timing.consecutive_losses > 0)
        return jittered;
      // Without allowance for losses, a fractional delay may need slightly more than the ages of
      // rule P.
      const double uniform = linear_passive_stiffness_filter(law.w0_rad_per_s, law.damping_ratio,
                                                             damping, problem.timing, lag);
      return std::min(jittered, uniform);
    }
    case Law::kDirect: {
      const double jittered =
          passive_stiffness_filter(kInfinity, 1.0, damping, problem.timing, lag);
      // Rule P holds for any timing within the bounds. Colgate's rule holds for the slowest timing
      // with whole samples. Both are applied.
      return std::min(jittered, colgate_stiffness(damping, slow.period_s, whole_delay(slow, lag)));
    }
    case Law::kSpringDamper:
      break;
  }
  double needed = 0.0;
  for (const LoopTiming& when : {problem.timing, slow})
    needed = std::max(needed, llewellyn_damping(law.stiffness, law.damping, when.period_s,
                                                whole_delay(when, lag)));
  return needed > 0.0 ? problem.series_ratio * damping / needed : kInfinity;
}

double certified_stiffness(const AxisProblem& problem, const LoopController& law, double enough) {
  if (problem.hand.any_passive)
    return certified_stiffness(problem, law, WorstCase{});
  return certified_stiffness(problem, law, critical_case(problem, law, problem.margin * enough));
}

double certified_stiffness(const AxisProblem& problem, const LoopController& law,
                           const WorstCase& worst) {
  const double limit = problem.hand.any_passive ? passive_limit(problem, law) : worst.stiffness;
  return std::min(limit / problem.margin, quiet_stiffness(problem, law));
}

double worst_radius(const AxisProblem& problem, const LoopController& law,
                    double contact_stiffness) {
  double worst = 0.0;
  try {
    for (const DesignCase& one : problem.cases)
      worst = std::max(worst, spectral_radius(one.plant, law, contact_stiffness));
  } catch (const std::runtime_error&) {
    return kInfinity;  // eigenvalues that do not converge certify nothing
  }
  return worst;
}

}  // namespace voxtouch::coupling::design
