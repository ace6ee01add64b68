#include "core/coupling/design/design_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace voxtouch {

namespace {

const AxisDesign& axis_of(const Design& design, std::size_t a) { return a == 0 ? design.translation : design.rotation; }

std::string shortfall(const AxisProblem& p, const AxisDesign& d) {
  if (d.critical_stiffness <= 0.0)
    return fmt::format("{}: no stiffness is stable ({}).", p.units->name, d.worst_case_text);
  return fmt::format("{}: {} becomes unstable at {:.3g} {}; with a margin of {:.3g}, {:.3g} of the {:.4g} {} wanted are shown.",
                     p.units->name, d.worst_case_text, d.critical_stiffness, p.units->stiffness, d.gain_margin,
                     d.shown_stiffness, p.wanted, p.units->stiffness);
}

std::string damping_reason(const AxisProblem& p, const AxisDesign& d, double wish_hz) {
  return fmt::format("{}: without damping in contact no cut-off from {:.3g} Hz upwards holds; {:.3g} {} behind a filter of {:.3g} Hz "
                     "are injected.", p.units->name, wish_hz, d.injected_damping, p.units->damping, d.velocity_filter_hz);
}

/// Largest share of the target that the wish's cut-off allows without injected damping.
std::string cutoff_reason(const DesignRequest& request, const std::vector<AxisProblem>& problems, const Design& design) {
  std::string held;
  for (const AxisProblem& p : problems) {
    double most = 0.0;
    for (const FilterShape& shape : filter_shapes(request))
      if (shape.cutoff_hz == request.wishes.cutoff_hz) most = std::max(most, certified_stiffness(p, law_of(shape), most));
    held += fmt::format("{}{:.3g} {}", held.empty() ? "" : " and ", most, p.units->stiffness);
  }
  return fmt::format("At {:.3g} Hz the filter lags by {:.3g} ms, and only {} hold without injected damping; the cut-off is {:.3g} Hz.",
                     request.wishes.cutoff_hz, 1e3 * 2.0 * design.spec.damping_ratio / (2.0 * std::numbers::pi * request.wishes.cutoff_hz),
                     held, design.spec.cutoff_hz);
}

}  // namespace

std::vector<std::string> reasons_of(const DesignRequest& request, const std::vector<AxisProblem>& problems,
                                    const Design& design) {
  std::vector<std::string> out;
  const bool filter = design.spec.kind == "shaping_filter";
  for (std::size_t a = 0; a < problems.size(); ++a) {
    const AxisProblem& p = problems[a];
    const AxisDesign& d = axis_of(design, a);
    if (p.contact.all_points > p.model.max_stiffness)
      out.push_back(fmt::format("{}: the device can show {:.4g} {}, and all points together have {:.4g}.", p.units->name,
                                p.model.max_stiffness, p.units->stiffness, p.contact.all_points));
    if (d.shown_stiffness < 0.999 * p.target) out.push_back(shortfall(p, d));
    if (d.injected_damping > 0.0) out.push_back(damping_reason(p, d, request.wishes.cutoff_hz));
  }
  if (filter && design.spec.cutoff_hz > request.wishes.cutoff_hz) out.push_back(cutoff_reason(request, problems, design));
  return out;
}

}  // namespace voxtouch
