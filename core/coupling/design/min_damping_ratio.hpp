#pragma once
/// Minimum damping ratios of the dominant mode of the loop: they limit how long it oscillates.
///
/// A case is one device in one hand with one timing (`design_cases`); its minimum is
/// `DesignCase::least_damping_ratio`. A hand that is only known to be passive has no minimum,
/// because such hands include masses that oscillate arbitrarily long.
#include "core/coupling/design/axis_verdict.hpp"
#include "core/coupling/design/designer.hpp"

namespace voxtouch::coupling::design {

/// The dominant mode of `spec` (at the hand, as `Design::spec`) at its displayed stiffness. Takes
/// some milliseconds.
DominantMode dominant_mode(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                           const CouplingSpec& spec);

/// Sets the minimum damping ratio of each case of `problems` from the goals of the request. Takes
/// some milliseconds.
/// A minimum is out of reach if a case stays below it even in the softest useful contact with the
/// best injected damping. If that holds for one hand, all hands lose their minimum, because
/// reducing the stiffness for the others would not shorten the longest oscillation. The same
/// applies to released devices. Returns the worst case out of reach and its best ratio.
LeastDamping set_min_damping(const DesignProblem& request, std::vector<AxisProblem>& problems);

/// Whether all cases meet their minimum with the contact stiffness `contact` ahead of `law` (of
/// unit gain).
bool meets_min_damping(const AxisProblem& problem, const LoopController& law, double contact);
/// The same. It checks the case `first` first and stores the failing case there, since that case is
/// likely to fail next time too.
bool meets_min_damping(const AxisProblem& problem, const LoopController& law, double contact,
                       std::size_t& first);
/// The same for all axes of `spec` at a `fraction` of its displayed stiffness: a spring-damper
/// scales its whole law, other kinds scale the contact.
bool meets_min_damping(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                       const CouplingSpec& spec, double fraction = 1.0);

/// The stiffest contact up to `most` that meets all minimum damping ratios, resolved to 1/4000; 0
/// if none does. For filter and direct coupling.
double damped_stiffness(const AxisProblem& problem, const LoopController& law, double most);
/// The largest fraction of a spring-damper that meets all minimum damping ratios, with the same
/// resolution.
double damped_fraction(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                       const CouplingSpec& spec);

}  // namespace voxtouch::coupling::design
