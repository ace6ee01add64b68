#pragma once
/// The oscillation at rest that encoder quantisation may cause.
#include "core/coupling/design/design_axis.hpp"

namespace voxtouch::coupling::design {

/// Sum of |x[n]| after a unit error of one position sample: the l1 norm of the loop from the
/// measured to the true position. An error within +- q/2 keeps the position within q/2 times that
/// sum, so q times it peak to peak. The tail beyond some ten thousand samples is extrapolated.
/// Requires a stable loop.
double quantisation_gain(const LoopPlant& plant, const LoopController& law,
                         double contact_stiffness);

/// Sum of |x[n]| after an effort of 1 for one sample: an effort within +- e keeps the position
/// within e times that sum.
double effort_gain(const LoopPlant& plant, const LoopController& law, double contact_stiffness);

/// Peak-to-peak oscillation that quantisation may cause, the worst over the cases; 0 if dry
/// friction removes it:
///     F_c >= S K k q / 2 + q/T (1 - exp(-wv T)) B + B * band
/// The second term is the injected damping of one encoder step. The third is the band within which
/// a slow velocity replaces the velocity of the law.
double limit_cycle_bound(const AxisProblem& problem, const LoopController& law,
                         double contact_stiffness, double displayed_stiffness,
                         double velocity_band);

}  // namespace voxtouch::coupling::design
