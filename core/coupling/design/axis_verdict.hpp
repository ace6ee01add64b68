#pragma once
/// Certificates of given parameters for each axis. The designer verifies its own choice with them
/// and evaluates other parameters.
#include <vector>

#include "core/coupling/design/design_axis.hpp"

namespace voxtouch::coupling::design {

/// Stiffness that a specification gives on one axis.
struct DisplayedStiffness {
  double contact = 0.0;    ///< ahead of the coupling, after the cap
  double displayed = 0.0;  ///< at the hand
  /// How much stiffer than one axis alone the coupled contact may be, in the order of symmetric
  /// matrices. It is 1 for force alone or under two caps, and 2 for force and torque without caps
  /// (see `axis_problems`).
  double coupling = 1.0;
};
/// One result for each problem. A cap below the contact's own bound replaces it.
std::vector<DisplayedStiffness> displayed_stiffness(const DesignProblem& request,
                                                    const std::vector<AxisProblem>& problems,
                                                    const CouplingSpec& spec);

struct AxisVerdict {
  AxisDesign design;
  std::vector<DesignReason> faults;  ///< why the certificates do not hold; empty: they do
};
/// Evaluates margin, injected damping limits, the device's limit and, over all cases, the spectral
/// radius at margin * displayed stiffness and at a hundredth of it. `worst`: an already computed
/// `critical_case` for filter or direct coupling.
AxisVerdict judge_axis(const DesignProblem& request, const AxisProblem& problem,
                       const CouplingSpec& spec, const DisplayedStiffness& displayed,
                       const WorstCase* worst = nullptr);
/// Adds the informative results of an axis, on which no verdict depends: the bound of the limit
/// cycle, and the device damping that would be required.
void describe_axis(const DesignProblem& request, const AxisProblem& problem,
                   const CouplingSpec& spec, const DisplayedStiffness& displayed, AxisDesign& out);

/// A series spring always reduces the stiffness: this fraction of the target counts as the goal.
inline constexpr double kSeriesRatio = 0.9;

/// Fastest approach [m/s] at which a tool is stopped within the force layer [m] by the softest
/// contact, a single point. The worst over the cases of
///
///     depth <= v (tau + min(sqrt(M / K k), M / B)),   tau = 2 d / w0 + T/2 + delay + lag
///
/// A hand that keeps pushing with a force F uses F / (K k) of the depth in addition. Returns 0 for
/// zero depth.
double max_approach(const AxisProblem& problem, const CouplingSpec& spec, double depth_m);

}  // namespace voxtouch::coupling::design
