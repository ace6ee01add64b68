#include "core/identification/stroke_plan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace voxtouch::identification {
namespace {

constexpr double kRampRatio = 0.25;  // of the duration, at each end
constexpr double kShortestS = 0.4;
constexpr double kFastest = 0.1;            // [m/s]
constexpr double kAccelerationRatio = 0.6;  // of the force that friction leaves
constexpr double kViscousRatio = 0.5;
constexpr double kToneRatio = 0.36;
constexpr double kToneSpeedRatio = 0.33;  // root sum of squares, of the speed
constexpr double kToneSteps = 0.3;        // smallest amplitude in encoder steps

/// Smoothstep and its derivative.
std::array<double, 2> smooth(double s) noexcept {
  return {s * s * (3.0 - 2.0 * s), 6.0 * s * (1.0 - s)};
}

}  // namespace

ReferencePoint StrokePlan::at(double time_s, double clock_s, double path,
                              double tone_scale) const noexcept {
  if (time_s <= 0.0 || time_s >= duration_s)
    return {};
  const double ramp = kRampRatio * duration_s;
  double weight = 1.0, slope = 0.0;
  if (time_s < ramp) {
    const auto [w, d] = smooth(time_s / ramp);
    weight = w;
    slope = d / ramp;
  } else if (time_s > duration_s - ramp) {
    const auto [w, d] = smooth((duration_s - time_s) / ramp);
    weight = w;
    slope = -d / ramp;
  }
  double tone = 0.0, tone_slope = 0.0;
  for (std::size_t k = 0; k < tone_count; ++k) {
    const double angle = tones[k].omega * clock_s + tones[k].phase;
    tone += tones[k].speed * std::cos(angle);
    tone_slope -= tones[k].speed * tones[k].omega * std::sin(angle);
  }
  const double speed = path / ((1.0 - kRampRatio) * duration_s) + tone_scale * tone;
  return {weight * speed, slope * speed + weight * tone_scale * tone_slope};
}

StrokePlan plan_stroke(const AxisModel& m, const StrokeGoals& g) noexcept {
  StrokePlan out;
  const double friction = m.coulomb_n + std::abs(m.bias_n);
  const double left = std::max(0.05 * g.allowed_force_n, g.allowed_force_n - friction);
  const double inertial = 8.0 * m.mass_kg / (kAccelerationRatio * left);  // path = T^2 / inertial
  const double viscous =
      std::max(0.0, m.viscous_ns_per_m) / ((1.0 - kRampRatio) * kViscousRatio * left);
  double path = g.path_m;
  out.duration_s = std::max({kShortestS, std::sqrt(inertial * path), viscous * path,
                             path / ((1.0 - kRampRatio) * kFastest)});
  out.duration_s = std::min(out.duration_s, g.longest_s);
  path = std::min(path, out.duration_s * out.duration_s / inertial);
  if (viscous > 0.0)
    path = std::min(path, out.duration_s / viscous);
  out.path_m = path;
  const double speed = path / ((1.0 - kRampRatio) * out.duration_s);
  const double highest = std::min(g.highest_hz, 0.2 * g.rate_hz);
  out.tone_count = std::min(g.tones, kMostTones);
  const auto n = static_cast<double>(out.tone_count);
  for (std::size_t k = 0; k < out.tone_count; ++k) {
    Tone& tone = out.tones[k];
    const double position = n > 1.0 ? static_cast<double>(k) / (n - 1.0) : 0.0;
    tone.omega = 2.0 * std::numbers::pi * g.lowest_hz * std::pow(highest / g.lowest_hz, position);
    tone.phase = -std::numbers::pi * static_cast<double>(k * k) / n;
    const double impedance = std::hypot(m.mass_kg * tone.omega, m.viscous_ns_per_m);
    const double by_force = kToneRatio * left / (std::sqrt(n) * impedance);
    const double by_speed = kToneSpeedRatio * speed / std::sqrt(n);
    const double by_steps = std::min(kToneSteps * g.encoder_step_m * tone.omega, 1.5 * by_force);
    tone.speed = std::max(std::min(by_force, by_speed), std::min(by_steps, 1.5 * by_speed));
  }
  return out;
}

}  // namespace voxtouch::identification
