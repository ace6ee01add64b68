#pragma once
/// The oscillation at rest that encoder quantisation may cause.
#include "core/coupling/design/design_axis.hpp"

namespace voxtouch::coupling::design {

/// Sum of |x[n]| after an error of the first position sample and an effort added to the first
/// command: the l1 norm of the loop, if one of them is 1 and the other 0. Errors within +- q/2 keep
/// the position within q/2 times that sum, so q times it peak to peak. The tail beyond some ten
/// thousand samples is extrapolated. Requires a stable loop.
double pulse_gain(const LoopPlant& plant, const LoopController& law, double contact_stiffness,
                  double position_error, double effort);

/// Peak-to-peak oscillation that quantisation may cause, the worst over the cases; 0 if dry
/// friction removes it:
///     F_c >= S K k q / 2 + q/T (1 - exp(-wv T)) B + B * band
/// The second term is the injected damping of one encoder step. The third is the band within which
/// a slow velocity replaces the velocity of the law.
double limit_cycle_bound(const AxisProblem& problem, const LoopController& law,
                         double contact_stiffness, double displayed_stiffness,
                         double velocity_band);

}  // namespace voxtouch::coupling::design
