#include "core/coupling/design/certificates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/coupling/design/loop_response.hpp"

namespace voxtouch {
namespace {

constexpr double kPi = std::numbers::pi;

/// Place of the one maximum of `f` in [low, high], by golden section.
template <class Function>
double place_of_maximum(const Function& f, double low, double high) {
  constexpr double kShare = 1.0 / std::numbers::phi;
  double left = high - kShare * (high - low), right = low + kShare * (high - low);
  double at_left = f(left), at_right = f(right);
  for (int i = 0; i < 90 && right > left; ++i) {
    if (at_left > at_right) {
      high = right, right = left, at_right = at_left;
      left = high - kShare * (high - low), at_left = f(left);
    } else {
      low = left, left = right, at_left = at_right;
      right = low + kShare * (high - low), at_right = f(right);
    }
  }
  return 0.5 * (low + high);
}

double stiffness_for(double damping, double lag) {
  return lag > 0.0 ? std::max(0.0, damping) / lag : std::numeric_limits<double>::infinity();
}

/// Length of a half wave of the impulse response in units of 1/w0; d < 1.
double half_wave(double d) { return kPi / std::sqrt((1.0 - d) * (1.0 + d)); }

/// The largest lag [s] of linear_passive_stiffness_filter. It may have a maximum for every turn of the delay and a narrow one at
/// the filter's resonance: looked for on a grid that is fine against both, then narrowed down.
double largest_lag(double w0, double d, double period_s, int delay_samples) {
  const double g = 0.5 * w0 * period_s, resonance = 2.0 * std::atan(g), turn = 0.2 / (delay_samples + 1);
  const auto lag = [&](double angle) {
    const Phasor p(angle);
    return -0.5 * period_s * (std::polar(1.0, -(delay_samples + 0.5) * angle) * filter_response(g, d, p)).imag() / p.s;
  };
  std::vector<double> grid;
  for (double angle = 0.01 * resonance; angle < kPi; angle = std::min(1.05 * angle, angle + turn)) grid.push_back(angle);
  for (int i = -20; i <= 20; ++i)
    if (const double angle = resonance * (1.0 + 0.2 * i * std::min(d, 0.2)); angle < kPi) grid.push_back(angle);
  grid.push_back(kPi);
  std::sort(grid.begin(), grid.end());
  double largest = 2.0 * d / w0 + (delay_samples + 0.5) * period_s;  // towards angle 0
  for (std::size_t i = 1; i + 1 < grid.size(); ++i) {
    const double here = lag(grid[i]);
    if (here < lag(grid[i - 1]) || here < lag(grid[i + 1])) continue;
    largest = std::max({largest, here, lag(place_of_maximum(lag, grid[i - 1], grid[i + 1]))});
  }
  return std::max(largest, lag(kPi));
}

/// max over phi of a^2 U^2 + b sin^2((n+1) phi) with b >= 0; see llewellyn_damping.
double largest_extraction(double a, double b, int n) {
  const auto value = [&](double phi) {
    const double sine = std::sin((n + 1) * phi), u = sine / std::sin(phi);
    return a * a * u * u + b * sine * sine;
  };
  const double end = 0.5 * kPi / (n + 1), at_zero = a * a * (n + 1) * (n + 1);
  return std::max({at_zero, value(place_of_maximum(value, 0.0, end)), value(end)});
}

}  // namespace

double overshoot_shape(double d) { return d >= 1.0 ? 1.0 : 1.0 / std::tanh(0.5 * d * half_wave(d)); }

double lag_shape(double d) {
  if (d >= 1.0) return 2.0 * d;
  const double p = half_wave(d), s = std::sinh(0.5 * d * p);
  return 2.0 * d * overshoot_shape(d) + (std::isfinite(s) ? p / (2.0 * s * s) : 0.0);
}

FilterShape sampled_filter_shape(double w0, double d, double period_s) {
  constexpr double kShortStep = 1e-3, kLittleDamping = 0.02, kTail = 1e-15;
  const double turn = w0 * period_s, g = 0.5 * turn;
  if (d >= 1.0 && g <= 1.0) return {2.0 * d, 1.0};
  if (turn < kShortStep || d < kLittleDamping) {
    const double above = 1.0 + turn * turn;
    return {above * lag_shape(d), above * overshoot_shape(d)};
  }
  // The printed difference equation's response to one sample of 1. What is left decays with the slower pole's modulus.
  const double scale = 1.0 / (1.0 + 2.0 * d * g + g * g);
  const double b0 = g * g * scale, a1 = 2.0 * (g * g - 1.0) * scale, a2 = (1.0 - 2.0 * d * g + g * g) * scale;
  double before = b0, now = 2.0 * b0 - a1 * b0, sum = std::abs(before) + std::abs(now), moment = std::abs(now);
  double next = b0 - a1 * now - a2 * before;
  for (int i = 2; i < 10'000'000; ++i) {
    before = now, now = next, next = -a1 * now - a2 * before;
    sum += std::abs(now);
    moment += i * std::abs(now);
    if (i * (std::abs(now) + std::abs(before)) < kTail * moment) break;
  }
  return {turn * moment, sum};
}

double passive_stiffness_filter(double w0, double d, double device_damping, const LoopTiming& timing, double effort_lag_s) {
  const double longest = (1.0 + timing.jitter) * timing.period_s;
  const double age = timing.delay_s + effort_lag_s + (0.5 + timing.lost_in_a_row) * longest;
  if (std::isinf(w0)) return stiffness_for(device_damping, age);
  const FilterShape shape = sampled_filter_shape(w0, d, timing.period_s);
  return stiffness_for(device_damping, longest / timing.period_s * shape.lag / w0 + shape.overshoot * age);
}

double linear_passive_stiffness_filter(double w0, double d, double device_damping, const LoopTiming& timing,
                                       double effort_lag_s) {
  constexpr double kWhole = 1e-9;  // a delay that is whole but for rounding is whole
  const int n = static_cast<int>(std::ceil((timing.delay_s + effort_lag_s) / timing.period_s - kWhole));
  if (std::isinf(w0)) return colgate_stiffness(device_damping, 0.0, timing.period_s, n);
  return stiffness_for(device_damping, largest_lag(w0, d, timing.period_s, n));
}

double limit_cycle_friction(double d, double shown_stiffness, double resolution) {
  return 0.5 * overshoot_shape(d) * shown_stiffness * resolution;
}

double colgate_stiffness(double device_damping, double injected_damping, double period_s, int delay_samples) {
  return stiffness_for(device_damping - std::abs(injected_damping), 0.5 * period_s * (1 + 2 * delay_samples));
}

double llewellyn_damping(double stiffness, double damping, double period_s, int delay_samples) {
  const double a = 0.5 * stiffness * period_s;
  if (!(a + damping > 0.0)) return 0.0;
  return largest_extraction(a, damping * (damping + 2.0 * a), delay_samples) / (a + damping);
}

SpringDamperPair llewellyn_optimum(double device_damping, double period_s, int delay_samples) {
  // Everything is proportional to the device's damping; for a = 1 and w = 1 + r the need is max of (U^2 - sin^2)/w + w sin^2,
  // convex in w and, from w = (n+1)^2 on, above its value at w = 1 at the latest.
  const int most = (delay_samples + 1) * (delay_samples + 1);
  const auto need = [&](double w) { return largest_extraction(1.0, w * w - 1.0, delay_samples) / w; };
  const double w = place_of_maximum([&](double x) { return -need(x); }, 1.0, most + 1.0);
  const double a = std::max(0.0, device_damping) / need(w);
  return {2.0 * a / period_s, (w - 1.0) * a};
}

}  // namespace voxtouch
