#include "core/identification/axis_identification.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace voxtouch::identification {
namespace {

constexpr double kMostDelayS = 0.015;
constexpr std::array<std::string_view, 9> kOutcomes{
    "measured",        "friction_too_high", "does_not_move",   "wrong_direction", "left_bounds",
    "following_error", "encoder_stuck",     "invalid_samples", "not_identifiable"};

FitOptions options_for(const AxisModel& start, double period_s, double step) {
  return {.start = start,
          .longest_period_s = period_s,
          .most_delay_s = kMostDelayS,
          .encoder_step_m = step};
}

bool plausible(const AxisFigures& f) {
  return f.mass_kg.value > 1e-4 && f.mass_kg.value < 1e3 &&
         std::isfinite(f.viscous_ns_per_m.value) && std::isfinite(f.coulomb_n.value);
}

AxisModel careful(AxisModel m) {
  m.viscous_ns_per_m = std::max(0.0, m.viscous_ns_per_m);
  m.coulomb_n = std::max(0.0, m.coulomb_n);
  return m;
}

/// The mass for which the last pulse covers its measured path, without viscous friction:
///
///     X = P d^2 / (2 m) (1 + P / (2 Fc + P))
double mass_by_path(const PulseResult& p, double coulomb_n) {
  if (p.path_m <= 0.0)
    return 1.0;
  return p.force_n * p.length_s * p.length_s / (2.0 * p.path_m) *
         (1.0 + p.force_n / (2.0 * coulomb_n + p.force_n));
}

Fit fit_strokes(const FitInput& input, bool with_curves) {
  const double step = input.encoder_step_m;
  const std::vector<Window> windows =
      stroke_windows(*input.record, Part::kStroke, {.encoder_step_m = step});
  FitOptions options = options_for(input.model, input.limits.period_s, step);
  options.with_mode = true;
  options.with_lag = true;
  options.loss_passes = 5;
  options.with_curves = with_curves;
  return fit_output_error(*input.record, windows, options);
}

}  // namespace

std::vector<Curve> fitted_strokes(const FitInput& input) { return fit_strokes(input, true).curves; }

std::string_view name_of(Outcome outcome) noexcept {
  return kOutcomes[static_cast<std::size_t>(outcome)];
}

bool ends_session(Outcome outcome) noexcept {
  return outcome != Outcome::kMeasured && outcome != Outcome::kFrictionTooHigh &&
         outcome != Outcome::kNotIdentifiable && outcome != Outcome::kDoesNotMove;
}

AxisModel model_so_far(const FitInput& input) {
  const double step = input.encoder_step_m, period_s = input.limits.period_s;
  const AxisModel known = input.model;
  if (input.step == Step::kFitPulses) {
    std::vector<Window> windows = pulse_windows(*input.record, step);
    if (windows.size() > 6)
      windows.erase(windows.begin(), windows.end() - 6);
    FitOptions options = options_for({}, period_s, step);
    options.start.bias_n = known.bias_n;
    options.start.coulomb_n = known.coulomb_n;
    options.friction_known = true;
    options.most_delay_s = 8e-3;
    options.fewest_samples = 6;
    options.spacing_s = 0.0;
    const double by_path = mass_by_path(input.pulse, known.coulomb_n);
    const Fit fit = fit_output_error(*input.record, windows, options);
    AxisModel m = known;
    m.mass_kg = by_path;
    m.delay_s = 5e-3;
    const double ratio = fit.figures.mass_kg.value / by_path;
    if (!fit.converged || !(ratio > 0.2 && ratio < 2.0))
      return m;
    m.mass_kg = fit.figures.mass_kg.value;
    m.viscous_ns_per_m = std::clamp(fit.figures.viscous_ns_per_m.value, 0.0, 6.0);
    m.delay_s = fit.figures.delay_s.value;
    return careful(m);
  }
  const std::vector<Window> windows =
      stroke_windows(*input.record, Part::kProbeStroke,
                     {.skip_start = 0.2, .shortest_s = 0.08, .encoder_step_m = step});
  // From the grid: a wrong first model must not decide.
  const Fit fit = fit_output_error(*input.record, windows, options_for({}, period_s, step));
  if (!fit.converged || !plausible(fit.figures) || windows.size() < 3)
    return known;
  return careful(fit.figures.model());
}

AxisFigures final_figures(const FitInput& input) {
  AxisFigures figures;
  figures.break_away_n = input.break_away_n;
  Fit fit = fit_strokes(input, false);
  if (!fit.converged || !plausible(fit.figures) || fit.windows < 5 ||
      !(fit.figures.mass_kg.half_width < 0.2 * fit.figures.mass_kg.value))
    return figures;
  fit.figures.break_away_n = figures.break_away_n;
  fit.figures.outcome = Outcome::kMeasured;
  const double friction = fit.figures.coulomb_n.value + std::abs(fit.figures.bias_n.value);
  if (friction > kMostFrictionRatio * input.limits.allowed_force_n)
    fit.figures.outcome = Outcome::kFrictionTooHigh;
  return fit.figures;
}

ClockFigures clock_figures(const AxisRecord& record, double nominal) {
  ClockFigures out{.period_s = nominal};
  const auto& e = record.entries();
  std::vector<double> periods;
  std::size_t lost = 0;
  for (std::size_t i = 1; i < e.size(); ++i) {
    if (e[i].segment != e[i - 1].segment)
      continue;  // the record has gaps while a fit runs
    const double dt = e[i].time_s - e[i - 1].time_s;
    const int missing = static_cast<int>(std::lround(dt / nominal)) - 1;
    if (missing > 0) {
      lost += static_cast<std::size_t>(missing);
      out.consecutive_losses = std::max(out.consecutive_losses, missing);
    } else {
      periods.push_back(dt);
    }
  }
  if (periods.empty())
    return out;
  double sum = 0.0;
  for (const double dt : periods)
    sum += dt;
  out.period_s = sum / static_cast<double>(periods.size());
  for (double& dt : periods)
    dt = std::abs(dt / out.period_s - 1.0);
  const auto place = periods.begin() +
                     static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(periods.size() - 1));
  std::ranges::nth_element(periods, place);
  out.jitter = *place;
  out.loss = static_cast<double>(lost) / static_cast<double>(lost + e.size());
  return out;
}

}  // namespace voxtouch::identification
