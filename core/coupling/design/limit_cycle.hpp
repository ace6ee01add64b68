#pragma once
/// What the encoder's steps leave of an oscillation at rest.
#include "core/coupling/design/design_axis.hpp"

namespace voxtouch::coupling::design {

/// Sum of |x[n]| after a unit error of one position sample: the l1 norm of the loop from the read
/// position to the position. An error that stays within +- q/2 keeps the position within q/2 times
/// that, so q times it peak to peak. The tail beyond some ten thousand samples is extrapolated. The
/// loop has to be stable.
double quantisation_gain(const LoopPlant& plant, const LoopController& law,
                         double contact_stiffness);

/// Sum of |x[n]| after an effort of 1 that is given for one sample: what stays within +- e keeps
/// the position within e times that.
double effort_gain(const LoopPlant& plant, const LoopController& law, double contact_stiffness);

/// Peak to peak that quantisation may leave, the worst over the cases; 0 where dry friction removes
/// it: F_c >= S K k q / 2, plus the q/T (1 - exp(-wv T)) B that injected damping makes of one step,
/// plus B times the band within which a slow velocity may stand in for the law's.
double limit_cycle_bound(const AxisProblem& problem, const LoopController& law,
                         double contact_stiffness, double displayed_stiffness,
                         double velocity_band);

}  // namespace voxtouch::coupling::design
