#include "core/coupling/design/loop_fraction.hpp"

#include <algorithm>
#include <cmath>

#include "core/coupling/design/sampled_plant.hpp"

namespace voxtouch::coupling::design {
namespace {

using Law = LoopController::Law;

/// Numerator and denominator of the parts, each up to the named factor z - 1.
class Fraction {
 public:
  Fraction(const LoopPlant& p, const LoopController& c)
      : plant_(sample_plant(p)),
        c_(c),
        period_(p.period_s),
        integrates_(p.hand_stiffness == 0.0) {}

  LoopFraction operator()(const Arc& arc) const {
    const CircleValue& q = arc.z_less_one();
    const auto& e = plant_.step_less_one;
    CircleValue x = late(arc, 0), v = late(arc, 1);
    CircleValue plain = arc.constant(1.0);
    if (plant_.order == 3) {
      const CircleValue f = late(arc, 2);
      plain = shifted(q, -e(2, 2));
      x = arc.times(x, plain) + e(0, 2) * f;
      v = arc.times(v, plain) + e(1, 2) * f;
    }
    const CircleValue slower = shifted(q, -e(1, 1));
    CircleValue n = plant_.effort_unit * (arc.times(slower, x) + e(0, 1) * v);
    if (plant_.whole_delay > 0)
      n = arc.times(n, arc.delay(plant_.whole_delay));
    // Without the hand's spring e00 = e10 = 0, and z - 1 is a factor of the plant's denominator.
    CircleValue d = arc.times(
        plain, integrates_ ? slower
                           : shifted(arc.times(shifted(q, -e(0, 0)), slower), -e(0, 1) * e(1, 0)));
    if (c_.injected_damping > 0.0)
      damp(arc, n, d);
    return law(arc, n, d);
  }

 private:
  static CircleValue shifted(const CircleValue& a, double k) { return {a.even + k, a.odd}; }

  /// Effect of a command on one state.
  CircleValue late(const Arc& arc, int row) const {
    if (plant_.older[row] == 0.0)
      return arc.constant(plant_.newer[row]);
    return shifted(plant_.older[row] * arc.delay(1), plant_.newer[row]);
  }

  /// n/d becomes n/(d + B V n). V has the factor z - 1.
  void damp(const Arc& arc, CircleValue& n, CircleValue& d) const {
    CircleValue over, under = arc.constant(1.0);
    if (c_.velocity_window > 0) {
      for (int ago = 0; ago < window_span(c_.velocity_window); ++ago)
        over = over + window_weight(c_.velocity_window, ago) * arc.delay(ago + 1);
      over = 1.0 / period_ * over;
    } else {
      const double w = c_.velocity_filter_rad_per_s,
                   fresh = w > 0.0 ? -std::expm1(-w * period_) : 1.0;
      over = arc.constant(fresh / period_);
      under = shifted(arc.z_less_one(), fresh);
    }
    CircleValue damping = c_.injected_damping * arc.times(n, over);
    if (!integrates_)
      damping = arc.times(damping, arc.z_less_one());
    d = arc.times(d, under) + damping;
    n = arc.times(n, under);
  }

  LoopFraction law(const Arc& arc, const CircleValue& n, const CircleValue& d) const {
    if (c_.law == Law::kDirect)
      return {c_.gain * n, d, integrates_};
    const CircleValue& q = arc.z_less_one();
    if (c_.law == Law::kShapingFilter) {  // g^2 / (r^2 + 2 d g r + g^2) with r = (z - 1)/(z + 1)
      const double g = 0.5 * c_.w0_rad_per_s * period_;
      const CircleValue up = shifted(q, 2.0), low = g * g * arc.times(up, up);
      const CircleValue all = low + arc.times(q, q + 2.0 * c_.damping_ratio * g * up);
      return {c_.gain * arc.times(n, low), arc.times(d, all), integrates_};
    }
    // L = n/d + 1/Z with Z = c + r (1 - z^-1)/T.
    const CircleValue z = shifted(c_.damping / period_ * arc.times(q, arc.delay(1)), c_.stiffness);
    const CircleValue whole = integrates_ ? arc.times(q, d) : d;
    return {arc.times(n, z) + whole, arc.times(d, z), integrates_};
  }

  SampledPlant plant_;
  LoopController c_;
  double period_;
  bool integrates_;
};

}  // namespace

Arc::Arc(double middle, double half) noexcept : middle_(middle), half_(half) {
  const double sine = std::sin(0.5 * middle), cosine = std::cos(0.5 * middle);
  // half^2/2 of a second derivative that is half of sine or at most 1/4.
  const double curve = 0.25 * half * half;
  s_ = {2.0 * sine, cosine, curve * std::sin(std::min(0.5 * (middle + half), 1.5707963267948966))};
  c_ = {cosine, -0.5 * sine, 0.5 * curve};
  s_squared_ = times(s_, s_);
  z_less_one_ = {-0.5 * s_squared_, c_};
}

double kernel_curvature(int k, double from) noexcept {
  // sin(k a)/(2 sin(a/2)) = sum of cos((i - 1/2) a), i = 1..k; and by the product rule with s = 2
  // sin(a/2) >= its value at `from`.
  const double of_sum = k * (4.0 * k * k - 1.0) / 12.0, s = 2.0 * std::sin(0.5 * from);
  return std::min(of_sum, ((k + 2.0 / s) * k + 2.0 / (s * s) + 0.25) / s);
}

CircleValue Arc::delay(int k) const noexcept {
  if (k == 0)
    return constant(1.0);
  const double count = std::abs(k), sine = std::sin(count * middle_),
               cosine = std::cos(count * middle_);
  const double step = 0.5 * half_ * half_, sign = k > 0 ? -1.0 : 1.0;
  const double kernel = sine / s_.value, slope = (count * cosine - kernel * s_.slope) / s_.value;
  return {{cosine, -count * sine, step * count * count},
          {sign * kernel, sign * slope,
           half_ > 0.0 ? step * kernel_curvature(std::abs(k), middle_ - half_) : 0.0}};
}

CircleValue Arc::times(const CircleValue& a, const CircleValue& b) const noexcept {
  return {times(a.even, b.even) - times(s_squared_, times(a.odd, b.odd)),
          times(a.even, b.odd) + times(a.odd, b.even)};
}

TaylorModel Arc::norm(const CircleValue& a) const noexcept {
  return times(a.even, a.even) + times(s_squared_, times(a.odd, a.odd));
}

std::complex<double> value_in_the_middle(const LoopFraction& loop, const Arc& arc) noexcept {
  const std::complex<double> all = arc.at_middle(loop.numerator) / arc.at_middle(loop.denominator);
  return loop.integrates ? all / arc.at_middle(arc.z_less_one()) : all;
}

LoopOverArc loop_over_arc(const LoopPlant& plant, const LoopController& controller) {
  return Fraction(plant, controller);
}

}  // namespace voxtouch::coupling::design
