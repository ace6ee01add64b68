#include <algorithm>

#include "core/coupling/design/design_steps.hpp"
#include "core/coupling/design/filter_search.hpp"

namespace voxtouch::coupling::design {

namespace {

DesignReason shortfall(const DesignProblem& request, const AxisProblem& p, const Design& design) {
  using enum DesignLimit;
  const AxisDesign& d = axis_of(design, p.axis);
  if (d.critical_stiffness <= 0.0)
    return {kNoStableStiffness, p.axis, {}};
  const double quiet = quiet_stiffness(p, controller_of(design.spec, p, arm_squared(request)));
  // A step limits the damping too, hence less than its whole limit may be used.
  if ((quiet - d.displayed_stiffness) * p.model.resolution < 0.3 * p.step_limit)
    return {kEncoderStep, p.axis, {p.model.resolution, p.step_limit, p.model.coulomb_friction}};
  if (p.hand.any_passive)
    return {kPassiveHand, p.axis, {}};
  return {d.gain_margin > 1.01 * p.margin ? kMinDampingRatio : kStability, p.axis, {}};
}

/// The injected damping, and the cost of its bound with everything else unchanged.
DesignReason damping_reason(const DesignProblem& request, const AxisProblem& p,
                            const Design& design) {
  const AxisDesign& d = axis_of(design, p.axis);
  DesignReason out{DesignLimit::kInjectedDamping, p.axis, {}};
  AxisProblem unbounded = p;
  unbounded.damping_force_ratio = 0.0;
  if (design.spec.kind == "spring_damper" || !(d.displayed_stiffness < 0.999 * p.target))
    return out;
  const double with = d.critical_stiffness / p.margin,
               without = certified_stiffness(unbounded,
                                             controller_of(design.spec, p, arm_squared(request)));
  if (without > 1.01 * with)
    out.values = {without, with};
  return out;
}

/// What the requested cut-off allows without injected damping.
DesignReason cutoff_reason(const DesignProblem& request, const std::vector<AxisProblem>& problems) {
  DesignReason out{DesignLimit::kFilterLag, 0, {request.goals.cutoff_hz}};
  for (const AxisProblem& p : problems) {
    double& most = out.values[1 + p.axis];
    for (const FilterSetting& shape : filter_settings(request))
      if (shape.cutoff_hz == request.goals.cutoff_hz)
        most = std::max(most, certified_stiffness(p, law_of(shape), most));
  }
  return out;
}

}  // namespace

std::vector<DesignReason> reasons_of(const DesignProblem& request,
                                     const std::vector<AxisProblem>& problems,
                                     const Design& design) {
  std::vector<DesignReason> out;
  for (const AxisProblem& p : problems) {
    const AxisDesign& d = axis_of(design, p.axis);
    if (d.displayed_stiffness < 0.999 * p.target)
      out.push_back(shortfall(request, p, design));
    if (p.contact.all_points > p.model.max_stiffness)
      out.push_back(
          {DesignLimit::kDeviceStiffness, p.axis, {p.model.max_stiffness, p.contact.all_points}});
    if (d.injected_damping > 0.0)
      out.push_back(damping_reason(request, p, design));
  }
  if (design.spec.kind == "shaping_filter" && design.spec.cutoff_hz > request.goals.cutoff_hz)
    out.push_back(cutoff_reason(request, problems));
  return out;
}

}  // namespace voxtouch::coupling::design
