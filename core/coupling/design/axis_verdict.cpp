#include "core/coupling/design/axis_verdict.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/coupling/design/certificates.hpp"
#include "core/coupling/design/filter_search.hpp"
#include "core/coupling/design/limit_cycle.hpp"
#include "core/coupling/design/slow_velocity.hpp"

namespace voxtouch::coupling::design {
namespace {

using Law = LoopController::Law;

bool is_rotation(const AxisProblem& problem) { return problem.axis == 1; }

double cap_of(const CouplingSpec& spec, bool rotation) {
  return rotation ? spec.stiffness_cap_nm_per_rad : spec.stiffness_cap_n_per_m;
}

double after_coupling(const LoopController& law, double gain, double contact) {
  if (law.law == Law::kShapingFilter)
    return gain * contact;
  if (law.law == Law::kDirect)
    return contact;
  return law.stiffness * contact / (law.stiffness + contact);
}

/// The law with its effort times `scale`. For filter and direct coupling the contact scales
/// instead.
LoopController scaled(LoopController law, double scale) {
  if (law.law == Law::kSpringDamper)
    law.stiffness *= scale, law.damping *= scale;
  return law;
}

/// Finds critical stiffness, margin and worst case.
void find_margin(const AxisProblem& problem, const CouplingSpec& spec, const LoopController& law,
                 const DisplayedStiffness& at, const WorstCase* known, AxisDesign& out) {
  out.any_passive_hand = problem.hand.any_passive;
  const double limit = passive_limit(problem, law);
  WorstCase worst;
  if (law.law == Law::kSpringDamper) {
    // An uncapped contact may have any stiffness; the coupling does not depend on it.
    const bool capped = std::isfinite(cap_of(spec, is_rotation(problem)));
    worst = critical_scale(problem, law, capped ? at.coupling * at.contact : kInfinity);
    out.gain_margin = problem.hand.any_passive ? std::min(limit, worst.stiffness) : worst.stiffness;
    out.critical_stiffness = out.gain_margin * at.displayed;
    out.passive = limit * kRounding >= 1.0;
    out.passive_stiffness = limit * at.displayed;
  } else {
    worst = known ? *known : critical_case(problem, law);
    const double load = at.coupling * at.displayed;
    out.critical_stiffness =
        problem.hand.any_passive ? std::min(limit, worst.stiffness) : worst.stiffness;
    out.gain_margin = load > 0.0 ? out.critical_stiffness / load : 0.0;
    out.passive = load > 0.0 && load <= limit * kRounding;
    out.passive_stiffness = limit;
  }
  out.worst_case = problem.cases[worst.index];
}

/// Spectral radius at the margin; `low` receives the one at a hundredth of it.
double radius(const AxisProblem& problem, const LoopController& law, const DisplayedStiffness& at,
              double& low) {
  const double k = at.coupling * (law.law == Law::kSpringDamper ? at.contact : at.displayed);
  const LoopController harder = scaled(law, problem.margin),
                       softer = scaled(law, 0.01 * problem.margin);
  low = worst_radius(problem, softer, 0.01 * problem.margin * k);
  return worst_radius(problem, harder, problem.margin * k);
}

void find_faults(const AxisProblem& problem, const LoopController& law, const CouplingSpec& spec,
                 const DisplayedStiffness& at, double low_radius, AxisVerdict& verdict) {
  using enum DesignLimit;
  const AxisDesign& d = verdict.design;
  const auto fault = [&](DesignLimit what, double value = 0.0) {
    verdict.faults.push_back({what, problem.axis, {value}});
  };
  if (!(d.gain_margin * kRounding >= problem.margin))
    fault(kGainMargin, problem.margin);
  else if (!(d.spectral_radius < 1.0 && low_radius < 1.0))
    fault(kSlowestMode, std::max(d.spectral_radius, low_radius));
  if (at.displayed > problem.model.max_stiffness * kRounding)
    fault(kDisplayedStiffness, problem.model.max_stiffness);
  if (law.injected_damping <= 0.0)
    return;
  if (problem.hand.any_passive)
    fault(kDampingPassiveHand);
  if (const double most = damping_limit(problem, velocity_of(spec));
      law.injected_damping > most * kRounding)
    fault(kDampingLimit, most);
  if (!is_rotation(problem) && !holds_on_slow_velocity(problem, spec, at))
    fault(kSlowVelocity, slow_ratio(problem, spec));
}

/// Device damping with which the whole target would be passive with the margin, at that cut-off and
/// the damping ratio that needs least. Infinity: no filter.
double passive_damping_required(const AxisProblem& problem, double cutoff_hz) {
  const double lag = effort_lag_s(problem.model);
  double most = 0.0;  // stiffness for unit damping: the rule is proportional to it
  for (const double ratio : {std::numbers::sqrt2 / 2.0, std::numbers::sqrt3 / 2.0, 0.577, 1.0})
    most = std::max(most, passive_stiffness_filter(2.0 * std::numbers::pi * cutoff_hz, ratio, 1.0,
                                                   problem.timing, lag));
  return problem.margin * problem.target / most;
}

/// The same for a spring-damper that reduces the target by at most a tenth.
double passive_damping_required_series(const AxisProblem& problem) {
  const LoopTiming slow = slowest(problem.timing);
  const double stiffness =
      llewellyn_optimum(1.0, slow.period_s, whole_delay(slow, effort_lag_s(problem.model)))
          .stiffness;
  return problem.margin * problem.target * kSeriesRatio / (1.0 - kSeriesRatio) / stiffness;
}

}  // namespace

std::vector<DisplayedStiffness> displayed_stiffness(const DesignProblem& request,
                                                    const std::vector<AxisProblem>& problems,
                                                    const CouplingSpec& spec) {
  bool matrix_capped = true;  // K6 <= diag(caps), and neither cap exceeds twice the bound that
                              // coupled axes can reach
  for (const AxisProblem& axis : problems)
    matrix_capped =
        matrix_capped && cap_of(spec, is_rotation(axis)) <= 2.0 * axis.contact.all_points;
  std::vector<DisplayedStiffness> out;
  for (const AxisProblem& axis : problems) {
    const double cap = cap_of(spec, is_rotation(axis));
    DisplayedStiffness at;
    at.contact = std::min(axis.contact.all_points, cap);
    at.displayed =
        after_coupling(controller_of(spec, axis, arm_squared(request)), spec.gain, at.contact);
    if (problems.size() > 1)
      at.coupling = matrix_capped ? std::min(cap, 2.0 * at.contact) / at.contact : 2.0;
    // The single law of the spring-damper acts along the whole wrench, including the arm. Its two
    // axes share the device's damping instead.
    if (spec.kind == "spring_damper")
      at.coupling = 1.0;
    out.push_back(at);
  }
  return out;
}

AxisVerdict judge_axis(const DesignProblem& request, const AxisProblem& problem,
                       const CouplingSpec& spec, const DisplayedStiffness& displayed,
                       const WorstCase* worst) {
  const LoopController law = controller_of(spec, problem, arm_squared(request));
  AxisVerdict verdict;
  AxisDesign& out = verdict.design;
  out.injected_damping = law.injected_damping;
  if (law.injected_damping > 0.0)
    out.velocity = velocity_of(spec);
  out.requested_stiffness = problem.requested;
  out.displayed_stiffness = displayed.displayed;
  find_margin(problem, spec, law, displayed, worst, out);
  double low = 0.0;
  out.spectral_radius = radius(problem, law, displayed, low);
  find_faults(problem, law, spec, displayed, low, verdict);
  return verdict;
}

void describe_axis(const DesignProblem& request, const AxisProblem& problem,
                   const CouplingSpec& spec, const DisplayedStiffness& displayed, AxisDesign& out) {
  const LoopController law = controller_of(spec, problem, arm_squared(request));
  const double contact = law.law == Law::kSpringDamper ? displayed.contact : displayed.displayed;
  out.limit_cycle_bound = limit_cycle_bound(
      problem, law, contact, displayed.displayed,
      !is_rotation(problem) && damps_on_slow_velocity(spec) ? spec.velocity_band_m_per_s : 0.0);
  out.damping_required =
      law.law == Law::kSpringDamper
          ? passive_damping_required_series(problem)
          : passive_damping_required(
                problem, law.law == Law::kShapingFilter ? request.goals.cutoff_hz : kInfinity);
}

double max_approach(const AxisProblem& problem, const CouplingSpec& spec, double depth_m) {
  const LoopController law = controller_of(spec, problem, 0.0);
  const double contact =
      std::min({problem.contact.one_point, problem.contact.all_points, spec.stiffness_cap_n_per_m});
  const double stiffness = after_coupling(law, spec.gain, contact);
  if (!(depth_m > 0.0 && stiffness > 0.0))
    return 0.0;
  double longest = 0.0;  // [s]: depth for each m/s
  for (const DesignCase& one : problem.cases) {
    const LoopPlant& p = one.plant;
    const double mass = p.mass + p.hand_mass,
                 damping = p.damping + p.hand_damping + law.injected_damping;
    const double stop =
        std::min(std::sqrt(mass / stiffness), damping > 0.0 ? mass / damping : kInfinity);
    longest = std::max(longest, lag_s(spec) + 0.5 * p.period_s + p.delay_s + p.effort_lag_s + stop);
  }
  return depth_m / longest;
}

}  // namespace voxtouch::coupling::design
