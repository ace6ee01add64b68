#include "core/coupling/design/designer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>

#include "core/coupling/design/axis_verdict.hpp"
#include "core/coupling/design/damping_floor.hpp"
#include "core/coupling/design/design_steps.hpp"
#include "core/coupling/design/slow_velocity.hpp"
#include "core/types/enum_name.hpp"

namespace voxtouch::coupling::design {
namespace {

/// What the last verification may take off, little by little, before the design counts as not
/// holding.
constexpr std::array kShrinks{1.0, 0.9999, 0.999, 0.99, 0.97, 0.95, 0.9, 0.8, 0.65, 0.5};
/// Another kind has to show that much more than the filter, which smooths what the contact does:
/// the search takes for as good what shows nine tenths.
constexpr double kWorthNoFilter = 1.1;
/// Floors that take such a share of what is shown without them are what limits, and are told first;
/// less is told behind what limits with and without them.
constexpr double kLimitingFloor = 0.1;
/// A bound on injected damping has to leave this of what is shown without it: the standard share,
/// or one that was asked for; and a larger one, which is taken for the stiffness that it gives
/// back.
constexpr double kWorthABound = 2.0 / 3.0, kWorthALargerShare = 0.9;

/// A coupling that was judged. What a person reads of it is worked out for the one that is taken
/// alone: see `told`.
struct Judged {
  Design design;
  std::vector<std::string> faults;
  std::vector<std::string> behind;  ///< what stands after the reasons
};

/// Certificates and what follows from them; status and sentences are the caller's.
Judged judged(const DesignProblem& request, const std::vector<AxisProblem>& problems,
              const CouplingSpec& spec, const std::vector<WorstCase>& worst = {}) {
  Judged out;
  out.design.spec = spec;
  const std::vector<ShownStiffness> shown = shown_stiffness(request, problems, spec);
  for (std::size_t a = 0; a < problems.size(); ++a) {
    AxisVerdict verdict =
        judge_axis(request, problems[a], spec, shown[a], worst.empty() ? nullptr : &worst[a]);
    (a == 0 ? out.design.translation : out.design.rotation) = std::move(verdict.design);
    out.faults.insert(out.faults.end(), verdict.faults.begin(), verdict.faults.end());
  }
  return out;
}

/// What holds of the spec whether it is certified or not.
void describe_spec(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                   Design& design) {
  const std::vector<ShownStiffness> shown = shown_stiffness(request, problems, design.spec);
  for (std::size_t a = 0; a < problems.size(); ++a)
    describe_axis(request, problems[a], design.spec, shown[a],
                  a == 0 ? design.translation : design.rotation);
  design.lag_s = lag_s(design.spec);
  design.max_approach_m_per_s =
      max_approach(problems[0], design.spec, request.goals.force_layer_depth_m);
  design.swing = slowest_swing(request, problems, design.spec);
}

bool too_soft(const std::vector<AxisProblem>& problems, const Design& design) {
  for (std::size_t a = 0; a < problems.size(); ++a)
    if (axis_of(design, a).shown_stiffness <
        std::min(problems[a].useful, 0.999 * problems[a].target))
      return true;
  return false;
}

/// Step 5.
Judged certified(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                 const Proposal& proposal) {
  Judged result;
  // Filter and direct keep the floors as they were proposed, axis by axis.
  const bool series = proposal.spec.kind == "spring_damper";
  const CouplingSpec spec =
      series ? shrunk(request, proposal.spec, damped_share(request, problems, proposal.spec))
             : proposal.spec;
  for (const double factor : kShrinks) {
    result = judged(request, problems, shrunk(request, spec, factor), proposal.worst);
    if (result.faults.empty())
      break;
  }
  Design& design = result.design;
  design.status = proposal.status;
  if (!result.faults.empty() || too_soft(problems, design))
    design.status = DesignStatus::kInfeasible;
  return result;
}

/// Step 6: the design that is taken, with what follows from it. `problems`: those that it was made
/// for.
Design told(const DesignProblem& request, const std::vector<AxisProblem>& problems, Judged result) {
  Design& design = result.design;
  describe_spec(request, problems, design);
  design.reasons = reasons_of(request, problems, design);
  if (!result.faults.empty() && design.reasons.empty())
    design.reasons = result.faults;
  design.reasons.insert(design.reasons.end(), result.behind.begin(), result.behind.end());
  design.remedies = remedies_of(request, problems, design);
  return std::move(design);
}

/// Shown over wanted, of the axis that is worse off; 0 for what does not hold.
double worth(const std::vector<AxisProblem>& problems, const Design& design) {
  if (design.status == DesignStatus::kInfeasible)
    return 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < problems.size(); ++a)
    least = std::min(least, axis_of(design, a).shown_stiffness / problems[a].wanted);
  return least;
}

/// As `worth`, if the proposal were certified as it is: no more comes of it.
double hoped(const DesignProblem& request, const std::vector<AxisProblem>& problems,
             const Proposal& proposal) {
  const std::vector<ShownStiffness> shown = shown_stiffness(request, problems, proposal.spec);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < problems.size(); ++a)
    least = std::min(least, shown[a].shown / problems[a].wanted);
  return least;
}

Judged best_of_all(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                   Searched& searched) {
  const Proposal filter = propose_filter(request, problems, searched);
  Judged best = certified(request, problems, filter);
  if (best.design.status == DesignStatus::kAsRequested)
    return best;
  const double with_filter = worth(problems, best.design);
  double to_beat = kWorthNoFilter * with_filter;
  for (const auto propose : {propose_spring_damper, propose_direct}) {
    const Proposal proposal = propose(request, problems, searched);
    if (hoped(request, problems, proposal) < to_beat)
      continue;
    Judged other = certified(request, problems, proposal);
    const double shows = worth(problems, other.design);
    if (shows <= 0.0 || shows < to_beat)
      continue;
    other.behind = {
        fmt::format("Without the shaping filter the hand feels {:.3g} % of the stiffness wanted, "
                    "with it {:.3g} %.",
                    100.0 * shows, 100.0 * with_filter)};
    best = std::move(other);
    to_beat = shows * (1.0 + 1e-12);
  }
  return best;
}

Judged designed(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                Searched& searched) {
  const std::string& kind = request.goals.kind;
  if (kind == "shaping_filter")
    return certified(request, problems, propose_filter(request, problems, searched));
  if (kind == "spring_damper")
    return certified(request, problems, propose_spring_damper(request, problems, searched));
  if (kind == "direct")
    return certified(request, problems, propose_direct(request, problems, searched));
  return best_of_all(request, problems, searched);
}

/// A design with the floors of the goals, as far as they can be kept.
struct Damped {
  Judged judged;
  std::vector<AxisProblem> problems;       ///< that it was made for
  std::array<double, 2> without_floors{};  ///< shown by each axis
  enum class Floors { kNotAsked, kKept, kTakeAll } floors = Floors::kNotAsked;
};

/// `floored`: `problems` with their floors.
Damped damped(const DesignProblem& request, const std::vector<AxisProblem>& problems,
              const std::vector<AxisProblem>& floored, Searched& searched) {
  const DampingFloors &floors = request.goals.floors, &turning = request.goals.rotation_floors;
  Judged found = designed(request, problems, searched);
  const std::array shown{found.design.translation.shown_stiffness,
                         found.design.rotation.shown_stiffness};
  if (!(floors.released + floors.held + turning.released + turning.held > 0.0) ||
      found.design.status == DesignStatus::kInfeasible)
    return {std::move(found), problems, shown, Damped::Floors::kNotAsked};
  if (keeps_floors(request, floored, found.design.spec))
    return {std::move(found), problems, shown, Damped::Floors::kKept};
  Judged again = designed(request, floored, searched);
  if (again.design.status == DesignStatus::kInfeasible)
    return {std::move(found), problems, shown, Damped::Floors::kTakeAll};
  return {std::move(again), floored, shown, Damped::Floors::kKept};
}

/// What the hand feels of the stiffness wanted with the share that was taken, with the standard one
/// and without a bound, each over all.
std::string share_sentence(double share, double standard, double first, double last, double none) {
  return fmt::format(
      "Injected damping adds up to {:.2g} of the contact's force: with {:.2g}, the standard, "
      "{:.3g} % of the stiffness wanted would be shown "
      "instead of {:.3g} %, and without a bound {:.3g} %.",
      share, standard, 100.0 * first, 100.0 * last, 100.0 * none);
}
std::string no_share_sentence(std::span<const double> shares, double first, double last,
                              double none) {
  const std::string largest =
      shares.size() > 1 ? fmt::format(" and with {:.2g} {:.3g} %", shares.back(), 100.0 * last)
                        : "";
  return fmt::format(
      "Injected damping is not bounded by a share of the contact's force (damper_share {:.2g}), "
      "which would show {:.3g} %{} of the stiffness "
      "wanted instead of {:.3g} %: a blow is felt as hard as its speed, not as the contact.",
      shares.front(), 100.0 * first, largest, 100.0 * none);
}

Design told(const DesignProblem& request, Damped&& taken, const std::vector<AxisProblem>& floored,
            const std::string& out_of_reach) {
  const DampingFloors& floors = request.goals.floors;
  if (CouplingSpec& spec = taken.judged.design.spec;
      taken.judged.design.status != DesignStatus::kInfeasible) {
    AxisProblem translation =
        taken.floors == Damped::Floors::kKept ? floored[0] : taken.problems[0];
    translation.damper_share = spec.damper_share;
    choose_slow_velocity(translation, shown_stiffness(request, taken.problems, spec)[0], spec);
  }
  Design design = told(request, taken.problems, std::move(taken.judged));
  if (taken.floors == Damped::Floors::kNotAsked)
    return design;
  if (taken.floors == Damped::Floors::kTakeAll) {
    design.reasons.push_back(
        fmt::format("Damping ratios of {} released and {} held would leave less than is useful; "
                    "they are not kept.",
                    floors.released, floors.held));
  } else {
    design.floors.released = floors.released, design.floors.held = floors.held;
    design.floors.cost_n_per_m = taken.without_floors[0] - design.translation.shown_stiffness;
    design.floors.cost_nm_per_rad = taken.without_floors[1] - design.rotation.shown_stiffness;
    const std::string cost = floors_cost(taken.problems, design);
    const bool first = design.floors.cost_n_per_m > kLimitingFloor * taken.without_floors[0] ||
                       design.floors.cost_nm_per_rad > kLimitingFloor * taken.without_floors[1];
    if (!cost.empty())
      design.reasons.insert(first ? design.reasons.begin() : design.reasons.end(), cost);
  }
  design.floors.out_of_reach = out_of_reach;
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

Design design_coupling(const DesignProblem& asked) {
  refuse_impossible(asked);
  DesignProblem request = asked;
  std::vector<AxisProblem> problems = axis_problems(request), floored = problems;
  const std::string out_of_reach = set_floors(request, floored);
  Searched searched;
  const auto with_share = [&](double share) {
    request.goals.damper_share = problems[0].damper_share = floored[0].damper_share = share;
    return damped(request, problems, floored, searched);
  };
  const std::optional<double>& given = asked.goals.damper_share;
  const std::span<const double> shares =
      given ? std::span(&*given, 1) : std::span<const double>(kDamperShares);
  std::optional<Damped> unbounded;
  double none = 1.0, first = 0.0,
         last = 0.0;  // shown over wanted, without a bound (no more than all), and with the first
                      // and the last share that was tried
  for (const double share : shares) {
    Damped bounded = with_share(share);
    last = worth(problems, bounded.judged.design);
    if (share == shares.front())
      first = last;
    const double worth_it = share == shares.front() ? kWorthABound : kWorthALargerShare;
    if (!unbounded && share > 0.0 && last < worth_it &&
        bounded.judged.design.status != DesignStatus::kAsRequested)
      unbounded = with_share(0.0), none = worth(problems, unbounded->judged.design),
      request.goals.damper_share = share;
    if (unbounded && last < worth_it * none)
      continue;
    if (share != shares.front())
      bounded.judged.behind.push_back(share_sentence(share, shares.front(), first, last, none));
    return told(request, std::move(bounded), floored, out_of_reach);
  }
  request.goals.damper_share = 0.0;
  unbounded->judged.behind.push_back(no_share_sentence(shares, first, last, none));
  return told(request, std::move(*unbounded), floored, out_of_reach);
}

Design judge_coupling(const DesignProblem& asked, const CouplingSpec& spec) {
  DesignProblem request = asked;
  request.goals.damper_share = spec.damper_share;
  refuse_impossible(request);
  const std::vector<AxisProblem> problems = axis_problems(request);
  for (const CouplingIssue& issue :
       validate(spec, CouplingLimits{}, request.device.timing.period_s))
    if (issue.refuse)
      throw std::invalid_argument("Coupling design: " + issue.sentence);
  Judged result = judged(request, problems, spec);
  describe_spec(request, problems, result.design);
  result.design.status =
      result.faults.empty() ? DesignStatus::kAsRequested : DesignStatus::kInfeasible;
  result.design.reasons = std::move(result.faults);
  result.design.remedies = remedies_of(request, problems, result.design);
  return std::move(result.design);
}

}  // namespace voxtouch::coupling::design
