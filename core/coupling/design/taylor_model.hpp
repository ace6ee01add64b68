#pragma once
/// Functions of one real variable over a short interval, with a proven remainder bound. Internal to
/// this folder.
///
/// A model holds
///
///     f(m + x) = value + slope x + r(x),   |r(x)| <= rest for all |x| <= half
///
/// with the same half for all operands (Makino, Berz 2003: Taylor models, here of first order).
/// Sums and products keep the bound. It excludes the rounding of double precision, about 1e-15 of
/// the operands.
#include <cmath>

namespace voxtouch::coupling::design {

struct TaylorModel {
  double value = 0.0;
  double slope = 0.0;
  double rest = 0.0;
};

inline TaylorModel operator+(const TaylorModel& a, const TaylorModel& b) noexcept {
  return {a.value + b.value, a.slope + b.slope, a.rest + b.rest};
}
inline TaylorModel operator-(const TaylorModel& a, const TaylorModel& b) noexcept {
  return {a.value - b.value, a.slope - b.slope, a.rest + b.rest};
}
inline TaylorModel operator*(double k, const TaylorModel& a) noexcept {
  return {k * a.value, k * a.slope, std::abs(k) * a.rest};
}
inline TaylorModel operator+(const TaylorModel& a, double k) noexcept {
  return {a.value + k, a.slope, a.rest};
}

/// The product over |x| <= half.
inline TaylorModel product(const TaylorModel& a, const TaylorModel& b, double half) noexcept {
  const double most_a = std::abs(a.value) + std::abs(a.slope) * half;
  const double most_b = std::abs(b.value) + std::abs(b.slope) * half;
  return {a.value * b.value, a.value * b.slope + a.slope * b.value,
          std::abs(a.slope * b.slope) * half * half + a.rest * (most_b + b.rest) + b.rest * most_a};
}

/// Lower bound of the function over |x| <= half.
inline double least(const TaylorModel& a, double half) noexcept {
  return a.value - std::abs(a.slope) * half - a.rest;
}

}  // namespace voxtouch::coupling::design
