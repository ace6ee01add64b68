#pragma once
/// The loop of sampled_loop.hpp as a fraction of two polynomials in z, over an arc of the unit
/// circle with a proven bound. Internal to this folder.
///
/// On the circle, with z = e^{j angle} and s = 2 sin(angle/2), a function with real coefficients
/// has the form
///
///     even + j s odd
///
/// with `even` and `odd` even in the angle and smooth at 0. This pair avoids cancellation near z =
/// 1, where a slow loop has all its poles: z - 1 is the pair (-s^2/2, cos(angle/2)).
#include <complex>
#include <functional>

#include "core/coupling/design/sampled_loop.hpp"
#include "core/coupling/design/taylor_model.hpp"

namespace voxtouch::coupling::design {

/// even + j s odd, over one arc.
struct CircleValue {
  TaylorModel even, odd;
};

/// The angles [middle - half, middle + half] within [0, pi], and arithmetic over them.
class Arc {
 public:
  /// 0 < middle <= pi; 0 <= half <= middle. half = 0: one point.
  Arc(double middle, double half) noexcept;

  double middle() const noexcept { return middle_; }
  double half() const noexcept { return half_; }
  const TaylorModel& s() const noexcept { return s_; }            ///< 2 sin(angle/2)
  const TaylorModel& half_cosine() const noexcept { return c_; }  ///< cos(angle/2)
  const CircleValue& z_less_one() const noexcept { return z_less_one_; }

  CircleValue constant(double k) const noexcept { return {{k, 0.0, 0.0}, {}}; }
  /// z^-k for an integer k of any sign.
  CircleValue delay(int k) const noexcept;
  TaylorModel times(const TaylorModel& a, const TaylorModel& b) const noexcept {
    return product(a, b, half_);
  }
  CircleValue times(const CircleValue& a, const CircleValue& b) const noexcept;
  /// The square of the modulus.
  TaylorModel norm(const CircleValue& a) const noexcept;
  /// The value at the middle angle.
  std::complex<double> at_middle(const CircleValue& a) const noexcept {
    return {a.even.value, s_.value * a.odd.value};
  }

 private:
  double middle_, half_;
  TaylorModel s_, c_, s_squared_;
  CircleValue z_less_one_;
};

/// Bound of |d^2/da^2 (sin(k a) / (2 sin(a/2)))| for all angles from `from` to pi.
double kernel_curvature(int k, double from) noexcept;

inline CircleValue operator+(const CircleValue& a, const CircleValue& b) noexcept {
  return {a.even + b.even, a.odd + b.odd};
}
inline CircleValue operator*(double k, const CircleValue& a) noexcept {
  return {k * a.even, k * a.odd};
}

/// L = numerator / denominator. If the loop integrates, because the device is released, L =
/// numerator / ((z - 1) denominator).
struct LoopFraction {
  CircleValue numerator, denominator;
  bool integrates = false;
};
std::complex<double> value_in_the_middle(const LoopFraction& loop, const Arc& arc) noexcept;

/// L of 1 + k L = 0 over any arc.
using LoopOverArc = std::function<LoopFraction(const Arc&)>;

/// The L of `critical_stiffness` (sampled_loop.hpp) [m/N]: hold, delay, lag, device, hand, filter
/// and injected damping.
LoopOverArc loop_over_arc(const LoopPlant& plant, const LoopController& controller);

}  // namespace voxtouch::coupling::design
