#include "core/coupling/design/design_steps.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/coupling/design/filter_search.hpp"

namespace voxtouch::coupling::design {

namespace {

std::string shortfall(const DesignProblem& request, const AxisProblem& p, const Design& design,
                      const AxisDesign& d) {
  if (d.critical_stiffness <= 0.0)
    return fmt::format("{}: no stiffness is stable ({}).", p.units->name, d.worst_case_text);
  const double quiet = quiet_stiffness(p, controller_of(design.spec, p, arm_squared(request)));
  // A step limits the damping too, hence less than its whole limit may be used.
  if ((quiet - d.displayed_stiffness) * p.model.resolution < 0.3 * p.step_limit)
    return fmt::format(
        "{}: an encoder step of {:.2g} {} may make {:.2g} {}, since a released device with {:.2g} "
        "{} of dry friction bounces on it; displayed {:.3g}, requested {:.4g} {}.",
        p.units->name, p.model.resolution, p.units->position, p.step_limit, p.units->effort,
        p.model.coulomb_friction, p.units->effort, d.displayed_stiffness, p.requested,
        p.units->stiffness);
  if (p.hand.any_passive)
    return fmt::format(
        "{}: stability limit {:.3g} {} with any passive hand; at gain margin {:.3g}, displayed "
        "{:.3g}, requested {:.4g} {}.",
        p.units->name, d.critical_stiffness, p.units->stiffness, d.gain_margin,
        d.displayed_stiffness, p.requested, p.units->stiffness);
  if (d.gain_margin > 1.01 * p.margin)  // a limit other than stability
    return fmt::format(
        "{}: limited by the minimum damping ratio; displayed {:.3g}, requested {:.4g} {}; {} "
        "becomes unstable at {:.3g}.",
        p.units->name, d.displayed_stiffness, p.requested, p.units->stiffness, d.worst_case_text,
        d.critical_stiffness);
  return fmt::format(
      "{}: {} becomes unstable at {:.3g} {}; at gain margin {:.3g}, displayed {:.3g}, requested "
      "{:.4g} {}.",
      p.units->name, d.worst_case_text, d.critical_stiffness, p.units->stiffness, d.gain_margin,
      d.displayed_stiffness, p.requested, p.units->stiffness);
}

/// The injected damping, and the cost of its bound with everything else unchanged.
std::string damping_reason(const DesignProblem& request, const AxisProblem& p, const Design& design,
                           const AxisDesign& d) {
  std::string out = fmt::format(
      "{}: injected damping of {:.3g} {} (velocity from {}) increases the stable stiffness.",
      p.units->name, d.injected_damping, p.units->damping, describe(d.velocity));
  AxisProblem unbounded = p;
  unbounded.damping_force_ratio = 0.0;
  if (design.spec.kind == "spring_damper" || !(d.displayed_stiffness < 0.999 * p.target))
    return out;
  const double with = d.critical_stiffness / p.margin,
               without = certified_stiffness(unbounded,
                                             controller_of(design.spec, p, arm_squared(request)));
  if (without > 1.01 * with)
    out += fmt::format(
        " It is limited to {:.2g} of the contact force; unlimited (damping_force_ratio: 0), {:.4g} "
        "instead of {:.4g} {} is stable.",
        design.spec.damping_force_ratio, without, with, p.units->stiffness);
  return out;
}

/// What the requested cut-off allows without injected damping, and what was chosen instead.
std::string cutoff_reason(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                          const Design& design) {
  std::string reached;
  for (const AxisProblem& p : problems) {
    double most = 0.0;
    for (const FilterSetting& shape : filter_settings(request))
      if (shape.cutoff_hz == request.goals.cutoff_hz)
        most = std::max(most, certified_stiffness(p, law_of(shape), most));
    reached += fmt::format("{}{:.3g} {}", reached.empty() ? "" : " and ", most, p.units->stiffness);
  }
  return fmt::format(
      "At {:.3g} Hz the filter's lag allows only {} without injected damping; chosen cut-off "
      "{:.3g} Hz.",
      request.goals.cutoff_hz, reached, design.spec.cutoff_hz);
}

}  // namespace

std::string describe_bound(const CouplingSpec& spec) {
  if (!(spec.damping_force_ratio > 0.0 && spec.injected_damping_ns_per_m > 0.0))
    return "";
  return fmt::format("is limited to {:.3g} of the contact and effect force, plus {:.2g} N",
                     spec.damping_force_ratio, spec.damping_force_offset_n);
}

std::string describe_slow_velocity(const CouplingSpec& spec) {
  if (!damps_on_slow_velocity(spec))
    return "";
  return fmt::format(
      "uses a velocity filter of {:.3g} Hz within {:.2g} mm/s (encoder quantisation)",
      spec.slow_velocity_hz, 1e3 * spec.velocity_band_m_per_s);
}

std::string describe(const VelocityEstimate& velocity) {
  return velocity.window > 0 ? fmt::format("a window of {} samples", window_span(velocity.window))
                             : fmt::format("a filter of {:.3g} Hz", velocity.filter_hz);
}

std::string min_damping_cost(const std::vector<AxisProblem>& problems, const Design& design) {
  std::string of_axes;
  for (std::size_t a = 0; a < problems.size(); ++a) {
    const double cost =
                     a == 0 ? design.min_damping.cost_n_per_m : design.min_damping.cost_nm_per_rad,
                 left = axis_of(design, a).displayed_stiffness;
    if (cost > 0.001 * left)
      of_axes += fmt::format("{}{:.4g} of {:.4g} {}", of_axes.empty() ? "" : " and ", cost,
                             left + cost, problems[a].units->stiffness);
  }
  if (of_axes.empty())
    return "";
  return fmt::format(
      "The minimum damping ratios cost {} (released {:.2g}, gripped {:.2g}); min_damping_ratio: 0 "
      "in "
      "the scene's coupling removes them.",
      of_axes, design.min_damping.released, design.min_damping.gripped);
}

std::vector<std::string> reasons_of(const DesignProblem& request,
                                    const std::vector<AxisProblem>& problems,
                                    const Design& design) {
  std::vector<std::string> out;
  const bool filter = design.spec.kind == "shaping_filter";
  for (std::size_t a = 0; a < problems.size(); ++a) {
    const AxisProblem& p = problems[a];
    const AxisDesign& d = axis_of(design, a);
    if (d.displayed_stiffness < 0.999 * p.target)
      out.push_back(shortfall(request, p, design, d));
    if (p.contact.all_points > p.model.max_stiffness)
      out.push_back(fmt::format("{}: device limit {:.4g} {}, all points together {:.4g}.",
                                p.units->name, p.model.max_stiffness, p.units->stiffness,
                                p.contact.all_points));
    if (d.injected_damping > 0.0)
      out.push_back(damping_reason(request, p, design, d));
  }
  if (filter && design.spec.cutoff_hz > request.goals.cutoff_hz)
    out.push_back(cutoff_reason(request, problems, design));
  return out;
}

}  // namespace voxtouch::coupling::design
