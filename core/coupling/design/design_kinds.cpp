#include "core/coupling/design/design_steps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/coupling/design/axis_verdict.hpp"
#include "core/coupling/design/min_damping_ratio.hpp"

namespace voxtouch::coupling::design {
namespace {

void set_cap(CouplingSpec& spec, std::size_t axis, double cap) {
  (axis == 0 ? spec.stiffness_cap_n_per_m : spec.stiffness_cap_nm_per_rad) = cap;
}

void set_damping(CouplingSpec& spec, const AxisProblem& translation, const FilterChoice& choice) {
  spec.damping_force_ratio = translation.damping_force_ratio;
  // An encoder step causes a pulse of damping. A larger pulse in a soft contact would throw a
  // frictionless device repeatedly between the walls of a slot.
  spec.damping_force_offset_n = kQuietForceN;
  spec.velocity_filter_hz = choice.velocity.filter_hz,
  spec.velocity_window = static_cast<std::uint32_t>(choice.velocity.window);
  spec.injected_damping_ns_per_m = choice.damping[0];
  if (choice.damping.size() > 1)
    spec.injected_damping_nms_per_rad = choice.damping[1];
}

/// The stiffness that each axis may display with the choice, at most its target, and the worst
/// cases.
std::vector<double> fitting(const std::vector<AxisProblem>& problems, const FilterChoice& choice,
                            std::vector<WorstCase>& worst) {
  std::vector<double> out;
  for (std::size_t a = 0; a < problems.size(); ++a) {
    LoopController law = law_of(choice.shape);
    law.injected_damping = choice.damping[a];
    law.use(choice.velocity);
    worst.push_back(critical_case(problems[a], law));
    out.push_back(damped_stiffness(
        problems[a], law,
        std::min(problems[a].target, certified_stiffness(problems[a], law, worst.back()))));
  }
  return out;
}

}  // namespace

Proposal propose_filter(const DesignProblem& request, const std::vector<AxisProblem>& problems) {
  const FilterChoice choice =
      search_filter(problems, filter_settings(request), request.goals.allow_injected_damping,
                    request.goals.velocity_windows);
  Proposal out{{}, choice.status, {}};
  const std::vector<double> fits = fitting(problems, choice, out.worst);
  out.spec.kind = "shaping_filter";
  out.spec.cutoff_hz = choice.shape.cutoff_hz;
  out.spec.damping_ratio = choice.shape.damping_ratio;
  set_damping(out.spec, problems[0], choice);
  const bool free = request.goals.free_cap;
  double gain = 1.0;
  for (std::size_t a = 0; a < problems.size(); ++a)
    gain = std::min(
        gain, fits[a] / (free ? problems[a].contact.one_point : problems[a].contact.all_points));
  out.spec.gain = gain;
  for (std::size_t a = 0; a < problems.size(); ++a)
    set_cap(out.spec, a,
            free && gain > 0.0 ? std::min(fits[a] / gain, problems[a].contact.all_points)
                               : problems[a].contact.all_points);
  return out;
}

Proposal propose_direct(const DesignProblem& request, const std::vector<AxisProblem>& problems) {
  std::vector<AxisProblem> whole = problems;
  for (AxisProblem& axis : whole)
    axis.target = axis.requested;
  const FilterChoice choice =
      search_filter(whole, {{kInfinity, 1.0}}, request.goals.allow_injected_damping,
                    request.goals.velocity_windows);
  Proposal out{{}, choice.status, {}};
  const std::vector<double> fits = fitting(whole, choice, out.worst);
  out.spec.kind = "direct";
  set_damping(out.spec, problems[0], choice);
  for (std::size_t a = 0; a < whole.size(); ++a) {
    set_cap(out.spec, a, fits[a]);
    if (!request.goals.free_cap && fits[a] < whole[a].contact.all_points)
      out.status = DesignStatus::kInfeasible;
  }
  return out;
}

}  // namespace voxtouch::coupling::design
