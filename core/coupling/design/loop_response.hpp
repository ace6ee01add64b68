#pragma once
/// The parts of the sampled loop on the unit circle, from their factors. Internal to this folder.
///
/// Quantities that are small near z = 1 (z - 1, the plant's step less one, 1 - a) are computed
/// directly, without differences of numbers near 1. A device that moves at 1 rad/s under a 4 kHz
/// loop loses no digit.
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/coupling/design/sampled_loop.hpp"
#include "core/coupling/design/sampled_plant.hpp"

namespace voxtouch::coupling::design {

using Complex = std::complex<double>;

/// a/b for numbers whose squares are in range; the operator of the library is slower, because it
/// handles all numbers.
inline Complex quotient(const Complex& a, const Complex& b) noexcept {
  return a * std::conj(b) / std::norm(b);
}

/// z = e^{j angle} and derived values; 0 < angle <= pi [rad per sample]. A complex angle gives a z
/// off the unit circle.
template <class Angle>
struct BasicPhasor {
  explicit BasicPhasor(Angle angle_rad) noexcept
      : angle(angle_rad),
        s(std::sin(0.5 * angle_rad)),
        c(std::cos(0.5 * angle_rad)) {
    const Complex j(0.0, 1.0), half = c + j * s;
    z_inverse = (c - j * s) * (c - j * s);
    z_less_one = j * (2.0 * s) * half;
  }
  Angle angle, s, c;  ///< sine and cosine of half the angle
  Complex z_inverse, z_less_one;
};
using Phasor = BasicPhasor<double>;
/// z = e^{s T} on the line of one damping ratio, 0 <= ratio < 1:
///     s T = angle (j - ratio / sqrt(1 - ratio^2))
struct DecayingPhasor : BasicPhasor<Complex> {
  DecayingPhasor(double angle_rad, double ratio) noexcept
      : BasicPhasor(Complex(angle_rad, angle_rad * ratio / std::sqrt(1.0 - ratio * ratio))) {}
};

/// G(z): position per effort, with hold, delay and lag.
template <class Angle>
Complex plant_response(const SampledPlant& plant, const BasicPhasor<Angle>& p) noexcept {
  const auto& e = plant.step_less_one;
  const Complex q = p.z_less_one;
  Complex x = plant.newer[0] + plant.older[0] * p.z_inverse,
          v = plant.newer[1] + plant.older[1] * p.z_inverse;
  if (plant.order == 3) {
    const Complex f = quotient(plant.newer[2] + plant.older[2] * p.z_inverse, q - e(2, 2));
    x += e(0, 2) * f;
    v += e(1, 2) * f;
  }
  const Complex one_sample =
      quotient((q - e(1, 1)) * x + e(0, 1) * v, (q - e(0, 0)) * (q - e(1, 1)) - e(0, 1) * e(1, 0));
  return plant.effort_unit * one_sample * std::exp(Complex(0.0, -plant.whole_delay) * p.angle);
}

/// The estimated velocity per position, for the filter
///     V(z) = (1 - a)(1 - z^-1)/(T (1 - a z^-1))
/// and for a window (1 - z^-1)/T times its weights.
class VelocityResponse {
 public:
  VelocityResponse(double period_s, double filter_rad_per_s, int window = 0) noexcept
      : period_(period_s),
        fresh_(filter_rad_per_s > 0.0 ? -std::expm1(-filter_rad_per_s * period_s) : 1.0),
        window_(window) {}
  template <class Angle>
  Complex operator()(const BasicPhasor<Angle>& p) const noexcept {
    if (window_ == 0)
      return fresh_ / period_ * quotient(p.z_less_one, p.z_less_one + fresh_);
    Complex sum = 0.0;
    for (int ago = window_span(window_); ago-- > 0;)
      sum = sum * p.z_inverse + window_weight(window_, ago);
    return sum * p.z_less_one * p.z_inverse / period_;
  }

 private:
  double period_, fresh_;
  int window_;
};

/// H(z) of the shaping filter for K = 1, with r = (z - 1)/(z + 1) = j tan(angle/2):
///     g^2/(r^2 + 2 d g r + g^2)
template <class Angle>
Complex filter_response(double g, double damping_ratio, const BasicPhasor<Angle>& p) noexcept {
  const Angle low = g * g * p.c * p.c;
  return quotient(low, low - p.s * p.s + Complex(0.0, 2.0 * damping_ratio * g) * p.s * p.c);
}

/// Fraction of a damper's effect that remains in an oscillation that leaves the contact. The damper
/// adds no more than the ratio s of the law's force and takes no more than all of it. The ratio
/// compares the part of its fundamental that is ahead of the force with that of an unbounded
/// damper. `ratio`: response of the damper over that of the law at the frequency of the
/// oscillation, D = x + j y.
///
/// The force of the law acts over half of the period, as cos p. There the unbounded damper adds
/// x cos p - y sin p, which is clamped between -cos p and s cos p. The clamping changes at tan p =
/// (x - s)/y and (1 + x)/y. The integral of the product with -sin p over (pi/2) y is
///
///     (atan((s - x)/y) + atan((1 + x)/y)) / pi
///
/// This is a describing function, not a proof. A smaller oscillation, which stays in contact, keeps
/// more.
inline double residual_damping(const Complex& ratio, double fraction) noexcept {
  if (!(ratio.imag() > 0.0))
    return 1.0;  // too late to damp
  return (std::atan((fraction - ratio.real()) / ratio.imag()) +
          std::atan((1.0 + ratio.real()) / ratio.imag())) /
         std::numbers::pi;
}

/// Partial dampings with which a loop must also be stable, if at most `up_to` of a bounded damper
/// remains.
struct DamperPart {
  double part, up_to;
};
inline constexpr std::array<DamperPart, 6> kDamperParts{
    {{0.9, 0.95}, {0.75, 0.825}, {0.5, 0.625}, {0.25, 0.375}, {0.1, 0.175}, {0.03, 0.065}}};

/// L(z) of 1 + k L(z) = 0, the equation of the closed loop.
class LoopResponse {
 public:
  LoopResponse(const LoopPlant& p, const LoopController& c)
      : plant_(sample_plant(p)),
        velocity_(p.period_s, c.velocity_filter_rad_per_s, c.velocity_window),
        c_(c),
        g_(0.5 * c.w0_rad_per_s * p.period_s),
        period_(p.period_s) {}

  const SampledPlant& plant() const noexcept { return plant_; }

  /// The plant with its injected damping: G/(1 + G B V).
  template <class Angle>
  Complex damped_plant(const BasicPhasor<Angle>& p) const noexcept {
    const Complex g = plant_response(plant_, p);
    if (!(c_.injected_damping > 0.0))
      return g;
    return quotient(g, 1.0 + c_.injected_damping * g * velocity_(p));
  }
  /// `residual_damping` of this loop's damper for that contact stiffness; not for a spring-damper.
  double residual_damping(double contact_stiffness, double fraction,
                          const Phasor& p) const noexcept {
    const Complex shape = c_.law == LoopController::Law::kShapingFilter
                              ? filter_response(g_, c_.damping_ratio, p)
                              : Complex(1.0);
    return design::residual_damping(
        quotient(c_.injected_damping * velocity_(p), c_.gain * contact_stiffness * shape),
        fraction);
  }
  /// L from the response of the damped plant.
  Complex of(const Complex& g, const Phasor& p) const noexcept {
    switch (c_.law) {
      case LoopController::Law::kShapingFilter:
        return c_.gain * g * filter_response(g_, c_.damping_ratio, p);
      case LoopController::Law::kDirect:
        return c_.gain * g;
      case LoopController::Law::kSpringDamper:
        break;
    }
    return g + quotient(1.0, c_.stiffness + c_.damping / period_ * p.z_less_one * p.z_inverse);
  }

 private:
  SampledPlant plant_;
  VelocityResponse velocity_;
  LoopController c_;
  double g_, period_;
};

}  // namespace voxtouch::coupling::design
