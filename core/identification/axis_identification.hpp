#pragma once
/// One axis from its first sample to its figures.
#include "core/identification/axis_excitation.hpp"
#include "core/identification/output_error.hpp"

namespace voxtouch::identification {

/// Largest ratio of friction and bias to the allowed force at which figures are reported.
inline constexpr double kMostFrictionRatio = 0.6;

/// The model that the next step of the excitation uses, from the record so far: pulses, then probe
/// strokes. Never fails: without a usable fit it returns a careful guess. Not for the loop.
AxisModel model_so_far(const FitInput& input);

/// The figures of a finished record. Not for the loop.
AxisFigures final_figures(const FitInput& input);

/// The strokes behind `final_figures`, measured and fitted: the same fit once more.
std::vector<Curve> fitted_strokes(const FitInput& input);

/// Jitter and loss from the stamps of a record.
ClockFigures clock_figures(const AxisRecord& record, double nominal_period_s);

}  // namespace voxtouch::identification
