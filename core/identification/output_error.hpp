#pragma once
/// Fit by output error: the parameters for which the simulated positions match the measured ones.
///
///     min sum (x_k - x_model(t_k; m, b, Fc, c, tau, x0_w, v0_w))^2
///
/// Each window w moves in one direction, so the model is linear there: it is solved exactly between
/// events, and only b/m, tau and the mode are nonlinear. x0_w and v0_w are eliminated per window
/// (multiple shooting, Bock 1983; elimination, Golub and Pereyra 1973).
#include <vector>

#include "core/identification/estimates.hpp"
#include "core/identification/windows.hpp"

namespace voxtouch::identification {

struct FitOptions {
  AxisModel start;  ///< mass 0: unknown, the fit searches a grid of delay and b / m
  double longest_period_s = 1e-3;
  double most_delay_s = 0.02;
  double encoder_step_m = 0.0;
  bool with_mode = false;           ///< search for a structural mode
  bool with_lag = false;            ///< fit a force lag as a part of the delay
  std::size_t fewest_samples = 12;  ///< of a window
  double spacing_s = 0.8e-3;        ///< samples closer than this are skipped; every command counts
  int loss_passes = 0;              ///< searches for commands that the device lost
  bool friction_known = false;      ///< friction and bias are those of `start`
  bool with_curves = false;         ///< fills Fit::curves
};

/// A measured window and its residual.
struct Curve {
  int direction = 0;
  double start_s = 0.0;  ///< of the record
  /// From the window's start; position from its first sample; measured less modelled.
  std::vector<double> times_s, position_m, residual_m;
};

struct Fit {
  bool converged = false;
  AxisFigures figures;
  std::size_t windows = 0;
  double samples = 0.0;
  std::vector<Curve> curves;  ///< of the fit with these figures
};

/// Allocates; takes milliseconds to tenths of a second. Not for the loop.
Fit fit_output_error(const AxisRecord& record, const std::vector<Window>& windows,
                     const FitOptions& options);

}  // namespace voxtouch::identification
