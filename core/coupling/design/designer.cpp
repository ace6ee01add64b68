#include "core/coupling/design/designer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/coupling/design/axis_verdict.hpp"
#include "core/coupling/design/damping_floor.hpp"
#include "core/coupling/design/design_steps.hpp"
#include "core/types/enum_name.hpp"

namespace voxtouch::coupling::design {
namespace {

/// What the last verification may take off, little by little, before the design counts as not holding.
constexpr std::array kShrinks{1.0, 0.9999, 0.999, 0.99, 0.97, 0.95, 0.9, 0.8, 0.65, 0.5};
/// Another kind has to show that much more than the filter, which smooths what the contact does: the search takes for as good what shows nine tenths.
constexpr double kWorthNoFilter = 1.1;
/// Floors that take such a share of what is shown without them are what limits, and are told first; less is told behind what limits with and without them.
constexpr double kLimitingFloor = 0.1;
/// A bound on injected damping that leaves less than this of what is shown without it is not kept.
constexpr double kWorthABound = 2.0 / 3.0;

struct Judged {
  Design design;
  std::vector<std::string> faults;
};

/// Certificates and what follows from them; status and sentences are the caller's.
Judged judged(const DesignProblem& request, const std::vector<AxisProblem>& problems, const CouplingSpec& spec) {
  Judged out;
  out.design.spec = spec;
  const std::vector<ShownStiffness> shown = shown_stiffness(request, problems, spec);
  for (std::size_t a = 0; a < problems.size(); ++a) {
    AxisVerdict verdict = judge_axis(request, problems[a], spec, shown[a]);
    (a == 0 ? out.design.translation : out.design.rotation) = std::move(verdict.design);
    out.faults.insert(out.faults.end(), verdict.faults.begin(), verdict.faults.end());
  }
  out.design.lag_s = lag_s(spec);
  out.design.max_approach_m_per_s = max_approach(problems[0], spec, request.goals.force_layer_depth_m);
  return out;
}

/// What the passivity controller may add: half of what the worst case bears, less what is injected already.
void allow_passivity_damping(const std::vector<AxisProblem>& problems, CouplingSpec& spec) {
  const auto left = [&](std::size_t axis, double injected) {
    return std::max(0.0, 0.5 * critical_damping(problems[axis], velocity_of(spec)) - injected);
  };
  spec.passivity_damping_limit_ns_per_m = left(0, spec.injected_damping_ns_per_m);
  if (problems.size() > 1) spec.passivity_damping_limit_nms_per_rad = left(1, spec.injected_damping_nms_per_rad);
}

bool too_soft(const std::vector<AxisProblem>& problems, const Design& design) {
  for (std::size_t a = 0; a < problems.size(); ++a)
    if (axis_of(design, a).shown_stiffness < std::min(problems[a].useful, 0.999 * problems[a].target)) return true;
  return false;
}

/// Steps 5 and 6.
Design certified(const DesignProblem& request, const std::vector<AxisProblem>& problems, const Proposal& proposal) {
  Judged result;
  // Filter and direct keep the floors as they were proposed, axis by axis.
  const bool series = proposal.spec.kind == "spring_damper";
  const CouplingSpec spec = series ? shrunk(request, proposal.spec, damped_share(request, problems, proposal.spec)) : proposal.spec;
  for (const double factor : kShrinks) {
    result = judged(request, problems, shrunk(request, spec, factor));
    if (result.faults.empty()) break;
  }
  Design& design = result.design;
  design.status = proposal.status;
  if (!result.faults.empty() || too_soft(problems, design)) design.status = DesignStatus::kInfeasible;
  allow_passivity_damping(problems, design.spec);
  design.reasons = reasons_of(request, problems, design);
  if (!result.faults.empty() && design.reasons.empty()) design.reasons = result.faults;
  design.remedies = remedies_of(request, problems, design);
  return design;
}

/// Shown over wanted, of the axis that is worse off; 0 for what does not hold.
double worth(const std::vector<AxisProblem>& problems, const Design& design) {
  if (design.status == DesignStatus::kInfeasible) return 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < problems.size(); ++a)
    least = std::min(least, axis_of(design, a).shown_stiffness / problems[a].wanted);
  return least;
}

Design best_of_all(const DesignProblem& request, const std::vector<AxisProblem>& problems) {
  const Proposal filter = propose_filter(request, problems);
  Design best = certified(request, problems, filter);
  if (best.status == DesignStatus::kAsRequested) return best;
  const double with_filter = worth(problems, best);
  double to_beat = kWorthNoFilter * with_filter;
  for (const auto propose : {propose_spring_damper, propose_direct}) {
    Design other = certified(request, problems, propose(request, problems));
    const double shows = worth(problems, other);
    if (shows <= 0.0 || shows < to_beat) continue;
    other.reasons.push_back(fmt::format("Without the shaping filter the hand feels {:.3g} % of the stiffness wanted, with it {:.3g} %.",
                                        100.0 * shows, 100.0 * with_filter));
    best = std::move(other);
    to_beat = shows * (1.0 + 1e-12);
  }
  return best;
}

Design designed(const DesignProblem& request, const std::vector<AxisProblem>& problems) {
  const std::string& kind = request.goals.kind;
  if (kind == "shaping_filter") return certified(request, problems, propose_filter(request, problems));
  if (kind == "spring_damper") return certified(request, problems, propose_spring_damper(request, problems));
  if (kind == "direct") return certified(request, problems, propose_direct(request, problems));
  return best_of_all(request, problems);
}

/// The design without floors, its damper bounded as the goals say. Where that takes more than a third, the damper is not bounded, which the request
/// and the problems then say too.
Design with_bound(DesignProblem& request, std::vector<AxisProblem>& problems) {
  Design bounded = designed(request, problems);
  if (!(request.goals.damper_share > 0.0) || bounded.status == DesignStatus::kAsRequested) return bounded;
  const double with = worth(problems, bounded);
  if (with >= kWorthABound) return bounded;
  DesignProblem free = request;
  free.goals.damper_share = 0.0;
  std::vector<AxisProblem> free_problems = axis_problems(free);
  Design unbounded = designed(free, free_problems);
  const double without = worth(problems, unbounded);
  if (with >= kWorthABound * without) return bounded;
  unbounded.reasons.push_back(fmt::format("Injected damping is not bounded by a share of the contact's force (damper_share {:.2g}), which would show {:.3g} % of "
                                          "the stiffness wanted instead of {:.3g} %: a blow is felt as hard as its speed, not as the contact.",
                                          request.goals.damper_share, 100.0 * with, 100.0 * without));
  request = std::move(free), problems = std::move(free_problems);
  return unbounded;
}

/// `design`, made without the floors of the goals, or another that keeps them.
Design with_floors(const DesignProblem& request, std::vector<AxisProblem> problems, Design design) {
  const DampingFloors &floors = request.goals.floors, &turning = request.goals.rotation_floors;
  const bool asked = floors.released + floors.held + turning.released + turning.held > 0.0;
  if (!asked || design.status == DesignStatus::kInfeasible) return design;
  const std::string out_of_reach = set_floors(request, problems);
  Design damped = keeps_floors(request, problems, design.spec) ? design : designed(request, problems);
  if (damped.status == DesignStatus::kInfeasible) {
    damped = std::move(design);
    damped.reasons.push_back(fmt::format("Damping ratios of {} released and {} held would leave less than is useful; they are not kept.",
                                         floors.released, floors.held));
  } else {
    damped.swing = slowest_swing(request, problems, damped.spec);
    damped.floors.released = floors.released, damped.floors.held = floors.held;
    damped.floors.cost_n_per_m = design.translation.shown_stiffness - damped.translation.shown_stiffness;
    damped.floors.cost_nm_per_rad = design.rotation.shown_stiffness - damped.rotation.shown_stiffness;
    const std::string cost = floors_cost(problems, damped);
    const bool first = damped.floors.cost_n_per_m > kLimitingFloor * design.translation.shown_stiffness ||
                       damped.floors.cost_nm_per_rad > kLimitingFloor * design.rotation.shown_stiffness;
    if (!cost.empty()) damped.reasons.insert(first ? damped.reasons.begin() : damped.reasons.end(), cost);
  }
  damped.floors.out_of_reach = out_of_reach;
  return damped;
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
  constexpr std::array<std::string_view, 5> kNames{"as_requested", "bandwidth_raised", "damping_added", "stiffness_reduced",
                                                   "infeasible"};
  return name_in(kNames, status);
}

Design design_coupling(const DesignProblem& asked) {
  refuse_impossible(asked);
  DesignProblem request = asked;
  std::vector<AxisProblem> problems = axis_problems(request);
  Design design = with_bound(request, problems);
  design.swing = slowest_swing(request, problems, design.spec);
  return with_floors(request, problems, std::move(design));
}

Design judge_coupling(const DesignProblem& asked, const CouplingSpec& spec) {
  DesignProblem request = asked;
  request.goals.damper_share = spec.damper_share;
  refuse_impossible(request);
  const std::vector<AxisProblem> problems = axis_problems(request);
  for (const CouplingIssue& issue : validate(spec, CouplingLimits{}, request.device.timing.period_s))
    if (issue.refuse) throw std::invalid_argument("Coupling design: " + issue.sentence);
  Judged result = judged(request, problems, spec);
  result.design.status = result.faults.empty() ? DesignStatus::kAsRequested : DesignStatus::kInfeasible;
  result.design.reasons = std::move(result.faults);
  result.design.remedies = remedies_of(request, problems, result.design);
  result.design.swing = slowest_swing(request, problems, spec);
  return std::move(result.design);
}

}  // namespace voxtouch::coupling::design
