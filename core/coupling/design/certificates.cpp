#include "core/coupling/design/certificates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/coupling/design/loop_response.hpp"

namespace voxtouch::coupling::design {
namespace {

constexpr double kPi = std::numbers::pi;

/// Position of the single maximum of `f` in [low, high], by golden section.
template <class Function>
double place_of_maximum(const Function& f, double low, double high) {
  constexpr double kFraction = 1.0 / std::numbers::phi;
  double left = high - kFraction * (high - low), right = low + kFraction * (high - low);
  double at_left = f(left), at_right = f(right);
  for (int i = 0; i < 90 && right > left; ++i) {
    if (at_left > at_right) {
      high = right, right = left, at_right = at_left;
      left = high - kFraction * (high - low), at_left = f(left);
    } else {
      low = left, left = right, at_left = at_right;
      right = low + kFraction * (high - low), at_right = f(right);
    }
  }
  return 0.5 * (low + high);
}

double stiffness_for(double damping, double lag) {
  return lag > 0.0 ? std::max(0.0, damping) / lag : std::numeric_limits<double>::infinity();
}

/// Length of a half wave of the impulse response in units of 1/w0; d < 1.
double half_wave(double d) { return kPi / std::sqrt((1.0 - d) * (1.0 + d)); }

/// The objective of linear_passive_stiffness_filter: the device damping that a contact of stiffness
/// 1 requires at one angle.
class NeededDamping {
 public:
  /// w0 = infinity: no filter.
  NeededDamping(double w0, double d, const LoopTiming& timing, double effort_lag_s)
      : period_(timing.period_s),
        filtered_(std::isfinite(w0)),
        g_(filtered_ ? 0.5 * w0 * period_ : 0.0),
        d_(d),
        mass_(sample_plant(1.0, 0.0, 0.0, period_, timing.delay_s, effort_lag_s)),
        lag_rate_(mass_.order == 3 ? period_ / effort_lag_s : 0.0),
        standstill_lag_((filtered_ ? 2.0 * d / w0 : 0.0) + 0.5 * period_ + timing.delay_s +
                        effort_lag_s) {}

  double at(double angle) const {
    const Phasor p(angle);
    const Complex h = filtered_ ? filter_response(g_, d_, p) : Complex(1.0);
    return from((h * integral(p)).real(), std::norm(h) * spread(p));
  }
  double at_standstill() const { return from(-standstill_lag_, spread(Phasor(kSmallest))); }
  double resonance() const { return filtered_ ? 2.0 * std::atan(g_) : 1.0; }
  int whole_delay() const { return mass_.whole_delay; }

 private:
  /// The negated least eigenvalue of the Hermitian part of a c^H, with Re c^H a = `real` and |a|^2
  /// |c|^2 - |c^H a|^2 = `spread`.
  static double from(double real, double spread) {
    return 0.5 * (std::sqrt(real * real + spread) - real);
  }

  /// Integral of the effort over the command, sampled: the momentum of a free mass.
  Complex integral(const Phasor& p) const {
    const Complex sampled =
        delayed(p, 1) + (mass_.order == 3
                             ? mass_.step_less_one(1, 2) *
                                   quotient(delayed(p, 2), p.z_less_one - mass_.step_less_one(2, 2))
                             : 0.0);
    return period_ * quotient(sampled, p.z_less_one) *
           std::polar(1.0, -mass_.whole_delay * p.angle);
  }
  Complex delayed(const Phasor& p, int row) const {
    return mass_.newer[row] + mass_.older[row] * p.z_inverse;
  }

  /// Deviation of the effort from a pure hold with whole delay, for which it is 0. With the sums
  /// over the aliases w_k of the angle:
  ///     sum 1/(w_k^2 (1 + lag^2 w_k^2)) - |integral|^2
  /// Near standstill it is a difference of large numbers but constant, so it is evaluated at
  /// kSmallest there.
  double spread(const Phasor& p) const {
    if (p.angle < kSmallest)
      return spread(Phasor(kSmallest));
    double hold = 1.0 / (4.0 * p.s * p.s);
    if (lag_rate_ > 0.0) {  // sinh(r)/(cosh(r) - cos(angle)), for any r
      const double e = std::exp(-lag_rate_), gone = -std::expm1(-lag_rate_);
      hold -= gone * (1.0 + e) / (gone * gone + 4.0 * e * p.s * p.s) / (2.0 * lag_rate_);
    }
    return std::max(0.0, period_ * period_ * hold - std::norm(integral(p)));
  }

  static constexpr double kSmallest = 1e-3;
  double period_;
  bool filtered_;
  double g_, d_;
  SampledPlant mass_;
  double lag_rate_, standstill_lag_;
};

/// The maximum over all angles. There may be one for each 2 pi of the delay and a narrow one at
/// the resonance of the filter. A grid that is fine relative to both locates it; then the interval
/// is narrowed.
double largest(const NeededDamping& needed, double d) {
  const double resonance = needed.resonance(), largest_step = 0.2 / (needed.whole_delay() + 1);
  std::vector<double> grid;
  for (double angle = 0.01 * resonance; angle < kPi;
       angle = std::min(1.05 * angle, angle + largest_step))
    grid.push_back(angle);
  for (int i = -20; i <= 20; ++i)
    if (const double angle = resonance * (1.0 + 0.2 * i * std::min(d, 0.2)); angle < kPi)
      grid.push_back(angle);
  grid.push_back(kPi);
  std::sort(grid.begin(), grid.end());
  std::vector<double> values;
  for (const double angle : grid)
    values.push_back(needed.at(angle));
  const auto at = [&](double angle) { return needed.at(angle); };
  double most = std::max(needed.at_standstill(), *std::max_element(values.begin(), values.end()));
  for (std::size_t i = 1; i + 1 < grid.size(); ++i)
    if (values[i] >= values[i - 1] && values[i] >= values[i + 1] && values[i] > 0.9 * most)
      most = std::max(most, at(place_of_maximum(at, grid[i - 1], grid[i + 1])));
  return most;
}

/// The maximum over phi of a^2 U^2 + b sin^2((n+1) phi) with b >= 0; see llewellyn_damping.
double largest_extraction(double a, double b, int n) {
  const auto value = [&](double phi) {
    const double sine = std::sin((n + 1) * phi), u = sine / std::sin(phi);
    return a * a * u * u + b * sine * sine;
  };
  const double end = 0.5 * kPi / (n + 1), at_zero = a * a * (n + 1) * (n + 1);
  return std::max({at_zero, value(place_of_maximum(value, 0.0, end)), value(end)});
}

}  // namespace

double overshoot_shape(double d) {
  return d >= 1.0 ? 1.0 : 1.0 / std::tanh(0.5 * d * half_wave(d));
}

double lag_shape(double d) {
  if (d >= 1.0)
    return 2.0 * d;
  const double p = half_wave(d), s = std::sinh(0.5 * d * p);
  return 2.0 * d * overshoot_shape(d) + (std::isfinite(s) ? p / (2.0 * s * s) : 0.0);
}

FilterShape sampled_filter_shape(double w0, double d, double period_s) {
  constexpr double kShortStep = 1e-3, kLittleDamping = 0.02, kTail = 1e-15;
  const double angle = w0 * period_s, g = 0.5 * angle;
  if (d >= 1.0 && g <= 1.0)
    return {2.0 * d, 1.0};
  if (angle < kShortStep || d < kLittleDamping) {
    const double above = 1.0 + angle * angle;
    return {above * lag_shape(d), above * overshoot_shape(d)};
  }
  // Response of the printed difference equation to one sample of 1. The remainder decays with the
  // modulus of the slower pole.
  const double scale = 1.0 / (1.0 + 2.0 * d * g + g * g);
  const double b0 = g * g * scale, a1 = 2.0 * (g * g - 1.0) * scale,
               a2 = (1.0 - 2.0 * d * g + g * g) * scale;
  double before = b0, now = 2.0 * b0 - a1 * b0, sum = std::abs(before) + std::abs(now),
         moment = std::abs(now);
  double next = b0 - a1 * now - a2 * before;
  for (int i = 2; i < 10'000'000; ++i) {
    before = now, now = next, next = -a1 * now - a2 * before;
    sum += std::abs(now);
    moment += i * std::abs(now);
    if (i * (std::abs(now) + std::abs(before)) < kTail * moment)
      break;
  }
  return {angle * moment, sum};
}

double passive_stiffness_filter(double w0, double d, double device_damping,
                                const LoopTiming& timing, double effort_lag_s) {
  const double longest = (1.0 + timing.jitter) * timing.period_s;
  const double age = timing.delay_s + effort_lag_s + (0.5 + timing.consecutive_losses) * longest;
  if (std::isinf(w0))
    return stiffness_for(device_damping, age);
  const FilterShape shape = sampled_filter_shape(w0, d, timing.period_s);
  return stiffness_for(device_damping,
                       longest / timing.period_s * shape.lag / w0 + shape.overshoot * age);
}

double linear_passive_stiffness_filter(double w0, double d, double device_damping,
                                       const LoopTiming& timing, double effort_lag_s) {
  return stiffness_for(device_damping, largest(NeededDamping(w0, d, timing, effort_lag_s), d));
}

double limit_cycle_friction(double d, double displayed_stiffness, double resolution) {
  return 0.5 * overshoot_shape(d) * displayed_stiffness * resolution;
}

double colgate_stiffness(double device_damping, double period_s, int delay_samples) {
  return stiffness_for(device_damping, 0.5 * period_s * (1 + 2 * delay_samples));
}

double llewellyn_damping(double stiffness, double damping, double period_s, int delay_samples) {
  const double a = 0.5 * stiffness * period_s;
  if (!(a + damping > 0.0))
    return 0.0;
  return largest_extraction(a, damping * (damping + 2.0 * a), delay_samples) / (a + damping);
}

SpringDamperPair llewellyn_optimum(double device_damping, double period_s, int delay_samples) {
  // Everything is proportional to the device's damping. For a = 1 and w = 1 + r the requirement is
  // max of (U^2 - sin^2)/w + w sin^2. It is convex in w, and from w = (n+1)^2 on it exceeds its
  // value at w = 1.
  const int most = (delay_samples + 1) * (delay_samples + 1);
  const auto need = [&](double w) {
    return largest_extraction(1.0, w * w - 1.0, delay_samples) / w;
  };
  const double w = place_of_maximum([&](double x) { return -need(x); }, 1.0, most + 1.0);
  const double a = std::max(0.0, device_damping) / need(w);
  return {2.0 * a / period_s, (w - 1.0) * a};
}

}  // namespace voxtouch::coupling::design
