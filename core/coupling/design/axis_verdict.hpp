#pragma once
/// The certificates of given parameters, axis by axis: what the designer checks its own choice
/// with, and judges others by.
#include <string>
#include <vector>

#include "core/coupling/design/design_axis.hpp"

namespace voxtouch::coupling::design {

/// What a spec puts on one axis.
struct DisplayedStiffness {
  double contact = 0.0;    ///< before the coupling, after the cap
  double displayed = 0.0;  ///< at the hand
  /// How much stiffer than one axis alone the coupled contact may be, in the order of symmetric
  /// matrices: 1 for force alone or under two caps; 2 for force and torque without (see
  /// `axis_problems`).
  double coupling = 1.0;
};
/// For each problem. The caps count as the contact's own bound where they are below it.
std::vector<DisplayedStiffness> displayed_stiffness(const DesignProblem& request,
                                                    const std::vector<AxisProblem>& problems,
                                                    const CouplingSpec& spec);

struct AxisVerdict {
  AxisDesign design;
  std::vector<std::string> faults;  ///< why the certificates do not hold; empty: they do
};
/// Margin, spectral radius at margin * shown and at a hundredth of it on every case, bounds of the
/// injected damping, the device's limit. `worst`: for who knows `critical_case` of filter or
/// direct.
AxisVerdict judge_axis(const DesignProblem& request, const AxisProblem& problem,
                       const CouplingSpec& spec, const DisplayedStiffness& displayed,
                       const WorstCase* worst = nullptr);
/// The rest of an axis, on which no verdict rests: the bound of the limit cycle, and what damping
/// the device would need.
void describe_axis(const DesignProblem& request, const AxisProblem& problem,
                   const CouplingSpec& spec, const DisplayedStiffness& displayed, AxisDesign& out);

/// Device damping with which the whole target would be passive with the margin. Filter: at that
/// cut-off and the damping ratio that needs least; infinity for no filter.
double passive_damping_required(const AxisProblem& problem, double cutoff_hz);
/// The same through a spring-damper that takes no more than a tenth of the target.
double passive_damping_required_series(const AxisProblem& problem);

/// A spring in series always takes something: what shows this fraction of the target counts as the
/// goal.
inline constexpr double kSeriesRatio = 0.9;

/// Fastest approach [m/s] at which a tool is stopped within the force layer [m], by the softest
/// contact, one point alone: depth <= v (tau + min(sqrt(M / K k), M / B)), tau = 2 d / w0 + T/2 +
/// delay + lag, the worst over the cases. A hand that goes on pushing with a force F takes F / (K
/// k) of the depth beforehand. 0 for no depth.
double max_approach(const AxisProblem& problem, const CouplingSpec& spec, double depth_m);

}  // namespace voxtouch::coupling::design
