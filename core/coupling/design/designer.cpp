#include "core/coupling/design/designer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>

#include "core/coupling/design/axis_verdict.hpp"
#include "core/coupling/design/design_steps.hpp"
#include "core/coupling/design/min_damping_ratio.hpp"
#include "core/coupling/design/slow_velocity.hpp"
#include "core/types/enum_name.hpp"

namespace voxtouch::coupling::design {
namespace {

/// Reductions that the final verification may apply, step by step, until the design counts as
/// failed.
constexpr std::array kBackoffFactors{1.0, 0.9999, 0.999, 0.99, 0.97, 0.95, 0.9, 0.8, 0.65, 0.5};
/// Another kind must display this much more than the filter, which smooths the steps of the
/// contact. The search accepts nine tenths of the best as equal.
constexpr double kObjectiveWithoutFilter = 1.1;
/// If the minimum damping ratios cost at least this fraction of the displayed stiffness, they are
/// reported first as the limit. Otherwise they are reported after the other limits.
constexpr double kLimitingCost = 0.1;
/// Ratio of displayed stiffness that a bound on injected damping must keep compared with no bound.
/// The first applies to the default or a requested ratio, the second to a larger ratio, which is
/// chosen for the stiffness that it regains.
constexpr double kObjectiveOfBound = 2.0 / 3.0, kObjectiveOfLargerRatio = 0.9;

/// An evaluated coupling. Its reasons are only computed if it is chosen; see `finalize`.
struct Evaluation {
  Design design;
  std::vector<DesignReason> faults;
  std::vector<DesignReason> behind;  ///< after the reasons
};

/// Computes certificates and derived values; the caller sets status and reasons.
Evaluation evaluated(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                     const CouplingSpec& spec, const std::vector<WorstCase>& worst = {}) {
  Evaluation out;
  out.design.spec = spec;
  const std::vector<DisplayedStiffness> displayed = displayed_stiffness(request, problems, spec);
  for (std::size_t a = 0; a < problems.size(); ++a) {
    AxisVerdict verdict =
        judge_axis(request, problems[a], spec, displayed[a], worst.empty() ? nullptr : &worst[a]);
    (a == 0 ? out.design.translation : out.design.rotation) = std::move(verdict.design);
    out.faults.insert(out.faults.end(), verdict.faults.begin(), verdict.faults.end());
  }
  return out;
}

/// Computes the values of the specification that do not depend on its certification.
void describe_spec(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                   Design& design) {
  const std::vector<DisplayedStiffness> displayed =
      displayed_stiffness(request, problems, design.spec);
  for (std::size_t a = 0; a < problems.size(); ++a)
    describe_axis(request, problems[a], design.spec, displayed[a],
                  a == 0 ? design.translation : design.rotation);
  design.lag_s = lag_s(design.spec);
  design.max_approach_m_per_s =
      max_approach(problems[0], design.spec, request.goals.force_layer_depth_m);
  design.swing = dominant_mode(request, problems, design.spec);
}

bool too_soft(const std::vector<AxisProblem>& problems, const Design& design) {
  for (std::size_t a = 0; a < problems.size(); ++a)
    if (axis_of(design, a).displayed_stiffness <
        std::min(problems[a].useful, 0.999 * problems[a].target))
      return true;
  return false;
}

/// Step 5: certifies the proposal, reduced if needed.
Evaluation certified(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                     const Proposal& proposal) {
  Evaluation result;
  // Filter and direct coupling meet the minimum damping ratios as proposed, axis by axis.
  const bool series = proposal.spec.kind == "spring_damper";
  const CouplingSpec spec =
      series ? shrunk(request, proposal.spec, damped_fraction(request, problems, proposal.spec))
             : proposal.spec;
  for (const double factor : kBackoffFactors) {
    result = evaluated(request, problems, shrunk(request, spec, factor), proposal.worst);
    if (result.faults.empty())
      break;
  }
  Design& design = result.design;
  design.status = proposal.status;
  if (!result.faults.empty() || too_soft(problems, design))
    design.status = DesignStatus::kInfeasible;
  return result;
}

/// Step 6: completes the chosen design. `problems`: those that it was made for.
Design finalize(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                Evaluation result) {
  Design& design = result.design;
  describe_spec(request, problems, design);
  design.reasons = reasons_of(request, problems, design);
  if (!result.faults.empty() && design.reasons.empty())
    design.reasons = result.faults;
  design.reasons.insert(design.reasons.end(), result.behind.begin(), result.behind.end());
  return std::move(design);
}

/// Displayed over requested stiffness of the worse axis; 0 for an infeasible design.
double objective(const std::vector<AxisProblem>& problems, const Design& design) {
  if (design.status == DesignStatus::kInfeasible)
    return 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < problems.size(); ++a)
    least = std::min(least, axis_of(design, a).displayed_stiffness / problems[a].requested);
  return least;
}

/// Upper bound of `objective` for the proposal, as if it were certified unchanged.
double upper_bound(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                   const Proposal& proposal) {
  const std::vector<DisplayedStiffness> displayed =
      displayed_stiffness(request, problems, proposal.spec);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < problems.size(); ++a)
    least = std::min(least, displayed[a].displayed / problems[a].requested);
  return least;
}

Evaluation best_of_all(const DesignProblem& request, const std::vector<AxisProblem>& problems) {
  const Proposal filter = propose_filter(request, problems);
  Evaluation best = certified(request, problems, filter);
  if (best.design.status == DesignStatus::kAsRequested)
    return best;
  const double with_filter = objective(problems, best.design);
  double to_beat = kObjectiveWithoutFilter * with_filter;
  for (const auto propose : {propose_spring_damper, propose_direct}) {
    const Proposal proposal = propose(request, problems);
    if (upper_bound(request, problems, proposal) < to_beat)
      continue;
    Evaluation other = certified(request, problems, proposal);
    const double displayed = objective(problems, other.design);
    if (displayed <= 0.0 || displayed < to_beat)
      continue;
    other.behind = {{DesignLimit::kWithoutFilter, 0, {displayed, with_filter}}};
    best = std::move(other);
    to_beat = displayed * (1.0 + 1e-12);
  }
  return best;
}

Evaluation designed(const DesignProblem& request, const std::vector<AxisProblem>& problems) {
  const std::string& kind = request.goals.kind;
  if (kind == "shaping_filter")
    return certified(request, problems, propose_filter(request, problems));
  if (kind == "spring_damper")
    return certified(request, problems, propose_spring_damper(request, problems));
  if (kind == "direct")
    return certified(request, problems, propose_direct(request, problems));
  return best_of_all(request, problems);
}

/// A design with the minimum damping ratios of the goals, as far as they can be met.
struct Damped {
  Evaluation evaluated;
  std::vector<AxisProblem> problems;        ///< that it was made for
  std::array<double, 2> without_minimum{};  ///< displayed by each axis
  enum class Minimum { kNotRequested, kMet, kDropped } min_damping = Minimum::kNotRequested;
};

/// `with_minimum`: `problems` with their minimum damping ratios.
Damped damped(const DesignProblem& request, const std::vector<AxisProblem>& problems,
              const std::vector<AxisProblem>& with_minimum) {
  const MinDampingRatios &min_damping = request.goals.min_damping,
                         &of_rotation = request.goals.rotation_min_damping;
  Evaluation found = designed(request, problems);
  const std::array displayed{found.design.translation.displayed_stiffness,
                             found.design.rotation.displayed_stiffness};
  if (!(min_damping.released + min_damping.gripped + of_rotation.released + of_rotation.gripped >
        0.0) ||
      found.design.status == DesignStatus::kInfeasible)
    return {std::move(found), problems, displayed, Damped::Minimum::kNotRequested};
  if (meets_min_damping(request, with_minimum, found.design.spec))
    return {std::move(found), problems, displayed, Damped::Minimum::kMet};
  Evaluation again = designed(request, with_minimum);
  if (again.design.status == DesignStatus::kInfeasible)
    return {std::move(found), problems, displayed, Damped::Minimum::kDropped};
  return {std::move(again), with_minimum, displayed, Damped::Minimum::kMet};
}

Design finalize(const DesignProblem& request, Damped&& taken,
                const std::vector<AxisProblem>& with_minimum, const LeastDamping& out_of_reach) {
  const MinDampingRatios& min_damping = request.goals.min_damping;
  if (CouplingSpec& spec = taken.evaluated.design.spec;
      taken.evaluated.design.status != DesignStatus::kInfeasible) {
    AxisProblem translation =
        taken.min_damping == Damped::Minimum::kMet ? with_minimum[0] : taken.problems[0];
    translation.damping_force_ratio = spec.damping_force_ratio;
    choose_slow_velocity(translation, displayed_stiffness(request, taken.problems, spec)[0], spec);
  }
  Design design = finalize(request, taken.problems, std::move(taken.evaluated));
  if (taken.min_damping == Damped::Minimum::kNotRequested)
    return design;
  if (taken.min_damping == Damped::Minimum::kDropped) {
    design.reasons.push_back(
        {DesignLimit::kMinDampingDropped, 0, {min_damping.released, min_damping.gripped}});
  } else {
    design.min_damping.released = min_damping.released,
    design.min_damping.gripped = min_damping.gripped;
    design.min_damping.cost_n_per_m =
        taken.without_minimum[0] - design.translation.displayed_stiffness;
    design.min_damping.cost_nm_per_rad =
        taken.without_minimum[1] - design.rotation.displayed_stiffness;
    DesignReason cost{DesignLimit::kMinDampingCost, 0, {}};
    if (design.min_damping.cost_n_per_m > 0.001 * design.translation.displayed_stiffness)
      cost.values[0] = design.min_damping.cost_n_per_m;
    if (design.min_damping.cost_nm_per_rad > 0.001 * design.rotation.displayed_stiffness)
      cost.values[1] = design.min_damping.cost_nm_per_rad;
    const bool first =
        design.min_damping.cost_n_per_m > kLimitingCost * taken.without_minimum[0] ||
        design.min_damping.cost_nm_per_rad > kLimitingCost * taken.without_minimum[1];
    if (cost.values[0] + cost.values[1] > 0.0)
      design.reasons.insert(first ? design.reasons.begin() : design.reasons.end(), cost);
  }
  design.min_damping.out_of_reach = out_of_reach;
  return design;
}

}  // namespace

CouplingSpec shrunk(const DesignProblem& request, CouplingSpec spec, double factor) {
  if (spec.kind == "spring_damper") {
    spec.stiffness_n_per_m *= factor, spec.damping_ns_per_m *= factor;
  } else if (spec.kind == "direct" || request.goals.free_cap) {
    spec.stiffness_cap_n_per_m *= factor, spec.stiffness_cap_nm_per_rad *= factor;
  } else {
    spec.gain *= factor;
  }
  return spec;
}

std::string_view name_of(DesignStatus status) noexcept {
  constexpr std::array<std::string_view, 5> kNames{
      "as_requested", "bandwidth_raised", "damping_added", "stiffness_reduced", "infeasible"};
  return name_in(kNames, status);
}

Design design_coupling(const DesignProblem& original) {
  refuse_impossible(original);
  DesignProblem request = original;
  std::vector<AxisProblem> problems = axis_problems(request), with_minimum = problems;
  const LeastDamping out_of_reach = set_min_damping(request, with_minimum);
  const auto with_ratio = [&](double fraction) {
    request.goals.damping_force_ratio = problems[0].damping_force_ratio =
        with_minimum[0].damping_force_ratio = fraction;
    return damped(request, problems, with_minimum);
  };
  const std::optional<double>& given = original.goals.damping_force_ratio;
  const std::span<const double> fractions =
      given ? std::span(&*given, 1) : std::span<const double>(kDampingForceRatios);
  std::optional<Damped> unbounded;
  // Displayed over requested stiffness without a bound (at most 1), and with the first and the last
  // tried ratio.
  double none = 1.0, first = 0.0, last = 0.0;
  for (const double fraction : fractions) {
    Damped bounded = with_ratio(fraction);
    last = objective(problems, bounded.evaluated.design);
    if (fraction == fractions.front())
      first = last;
    const double enough =
        fraction == fractions.front() ? kObjectiveOfBound : kObjectiveOfLargerRatio;
    if (!unbounded && fraction > 0.0 && last < enough &&
        bounded.evaluated.design.status != DesignStatus::kAsRequested)
      unbounded = with_ratio(0.0), none = objective(problems, unbounded->evaluated.design),
      request.goals.damping_force_ratio = fraction;
    if (unbounded && last < enough * none)
      continue;
    if (fraction != fractions.front())
      bounded.evaluated.behind.push_back(
          {DesignLimit::kDampingForceRatio, 0, {fraction, fractions.front(), first, last, none}});
    return finalize(request, std::move(bounded), with_minimum, out_of_reach);
  }
  request.goals.damping_force_ratio = 0.0;
  DesignReason unlimited{DesignLimit::kNoDampingForceRatio, 0, {fractions.front(), first, none}};
  if (fractions.size() > 1)
    unlimited.values[3] = fractions.back(), unlimited.values[4] = last;
  unbounded->evaluated.behind.push_back(unlimited);
  return finalize(request, std::move(*unbounded), with_minimum, out_of_reach);
}

Design judge_coupling(const DesignProblem& original, const CouplingSpec& spec) {
  DesignProblem request = original;
  request.goals.damping_force_ratio = spec.damping_force_ratio;
  refuse_impossible(request);
  const std::vector<AxisProblem> problems = axis_problems(request);
  for (const CouplingIssue& issue :
       validate(spec, CouplingLimits{}, request.device.timing.period_s))
    if (issue.refuse)
      throw std::invalid_argument("Coupling design: " + issue.sentence);
  Evaluation result = evaluated(request, problems, spec);
  describe_spec(request, problems, result.design);
  result.design.status =
      result.faults.empty() ? DesignStatus::kAsRequested : DesignStatus::kInfeasible;
  result.design.reasons = std::move(result.faults);
  return std::move(result.design);
}

}  // namespace voxtouch::coupling::design
