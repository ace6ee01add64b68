#pragma once
/// The smallest gain at which 1 + gain L(z) = 0 has a root on the unit circle. Internal to this
/// folder.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "core/coupling/design/loop_response.hpp"

namespace voxtouch::coupling::design {

/// The outermost crossing of L with the negative real axis.
struct Crossing {
  double gain = std::numeric_limits<double>::infinity();  ///< -1/L there; infinity: no crossing
  double angle = 0.0;                                     ///< [rad per sample]
};

/// L and, if it is a sum, the summand that may have narrow resonances. Under a large smooth
/// summand, pole and zero of a resonance are so close that a step over both would miss it. The
/// phase of the summand itself changes by pi.
struct LoopSample {
  Complex value, summand;
};

/// Searches the upper half of the unit circle for crossings. Steps are halved wherever the phase or
/// modulus of L or its summand changes fast. If L approaches the negative real axis and departs
/// again, the search checks for a double crossing in between: such a loop is unstable for a band of
/// gains only. A response is a function of a Phasor that returns a LoopSample.
class CrossingSearch {
 public:
  /// `slow_periods`: sum of the loop's time constants in periods, >= 1. Below a fiftieth of its
  /// inverse no factor changes the phase of L by more than a fiftieth [rad], so the search begins
  /// there.
  /// `whole_delay`: samples of delay.
  CrossingSearch(double slow_periods, int whole_delay) noexcept
      : start_(0.02 / slow_periods),
        longest_step_(0.5 / (whole_delay + 3)) {}

  /// Adds an angle that no step may skip: the peak of a resonance, where the phase of L changes by
  /// pi within an arbitrarily small width. Two of them within one step would cancel. At most
  /// kMaxStops.
  void stop_at(double angle) noexcept {
    if (stops_count_ < kMaxStops)
      stops_[stops_count_++] = angle;
  }

  template <class Response>
  Crossing find(const Response& response) {
    best_ = {};
    Point from = at(response, start_);
    before_ = from;
    while (from.angle < kEnd) {
      double next = std::min({from.angle * kGrowth, from.angle + longest_step_, kEnd});
      for (const double stop : stops_)
        if (stop > from.angle)
          next = std::min(next, stop);
      const Point to = at(response, next);
      search_between(response, from, to, kMaxHalvings);
      from = to;
    }
    // At z = -1 all values are real: the loop may begin to alternate from sample to sample.
    const double last = response(Phasor(std::numbers::pi)).value.real();
    if (last < 0.0)
      offer(-1.0 / last, std::numbers::pi);
    return best_;
  }

 private:
  struct Point {
    double angle;
    Complex value, summand;
  };

  static constexpr int kMaxStops = 4, kMaxHalvings = 60;
  static constexpr double kGrowth = 1.3;
  static constexpr double kEnd = std::numbers::pi * (1.0 - 1e-7);
  static constexpr double kPhaseCosine2 =
      0.6;  ///< squared cosine of the largest phase change of L in a step that is not halved
  static constexpr double kMaxNormRatio = 100.0;  ///< largest factor of |L|^2 in such a step
  static constexpr double kSkipNormRatio =
      0.01;  ///< a step with |L|^2 below this fraction of the best crossing's is skipped

  template <class Response>
  static Point at(const Response& response, double angle) {
    const LoopSample sample = response(Phasor(angle));
    return {angle, sample.value, sample.summand};
  }

  static bool smooth(const Complex& a, const Complex& b) noexcept {
    const double na = std::norm(a), nb = std::norm(b);
    const double along = a.real() * b.real() + a.imag() * b.imag();
    return along > 0.0 && along * along > kPhaseCosine2 * na * nb && na < kMaxNormRatio * nb &&
           nb < kMaxNormRatio * na;
  }

  template <class Response>
  void search_between(const Response& response, const Point& a, const Point& b, int halvings) {
    if (std::max(std::norm(a.value), std::norm(b.value)) * best_.gain * best_.gain <
        kSkipNormRatio) {
      before_ = b;
      return;
    }
    if (halvings > 0 && !(smooth(a.value, b.value) && smooth(a.summand, b.summand))) {
      const Point middle = at(response, 0.5 * (a.angle + b.angle));
      if (middle.angle > a.angle && middle.angle < b.angle) {
        search_between(response, a, middle, halvings - 1);
        search_between(response, middle, b, halvings - 1);
        return;
      }
    }
    narrow(response, a, b);
    search_double_crossing(response, before_, a, b);
    before_ = a;
  }

  static bool on_both_sides(const Point& a, const Point& b) noexcept {
    return a.value.real() < 0.0 && b.value.real() < 0.0 &&
           std::signbit(a.value.imag()) != std::signbit(b.value.imag());
  }
  /// Tangent of the angle to the negative real axis.
  static double slope(const Point& p) noexcept { return p.value.imag() / p.value.real(); }

  /// Of three consecutive points on one side of the axis, the middle one is nearest to it.
  /// Approaches the axis between them until it is reached or the bracket is short.
  template <class Response>
  void search_double_crossing(const Response& response, const Point& left, const Point& middle,
                              const Point& right) {
    const auto away = [](const Point& p) {
      return p.value.real() < 0.0 ? std::abs(slope(p)) : 1e300;
    };
    if (!(away(middle) < away(left) && away(middle) <= away(right)))
      return;
    Point a = left, m = middle, b = right;
    for (int i = 0; i < 80 && b.angle - a.angle > 1e-7 * b.angle; ++i) {
      const bool upper = b.angle - m.angle > m.angle - a.angle;
      const Point c = at(response, upper ? m.angle + 0.4 * (b.angle - m.angle)
                                         : m.angle - 0.4 * (m.angle - a.angle));
      if (on_both_sides(c, m)) {
        narrow(response, upper ? m : a, c);  // crossing
        narrow(response, c, upper ? b : m);  // return
        return;
      }
      if (away(c) < away(m)) {
        (upper ? a : b) = m;
        m = c;
      } else {
        (upper ? b : a) = c;
      }
    }
  }

  /// Offers the root of Im L/Re L, if there is one, by the Illinois rule: secants that never leave
  /// the bracket.
  template <class Response>
  void narrow(const Response& response, Point a, Point b) {
    if (!on_both_sides(a, b))
      return;
    double fa = slope(a), fb = slope(b);
    for (int i = 0; i < 60 && fa != fb; ++i) {
      const Point c = at(response, b.angle - fb * (b.angle - a.angle) / (fb - fa));
      const double fc = slope(c), moved = std::abs(c.angle - b.angle);
      if ((fc < 0.0) != (fb < 0.0)) {
        a = b, fa = fb;
      } else {
        fa *= 0.5;
      }
      b = c, fb = fc;
      if (fc == 0.0 || moved <= 1e-15 * c.angle)
        break;
    }
    offer(-1.0 / b.value.real(), b.angle);
  }

  void offer(double gain, double angle) noexcept {
    if (gain < best_.gain)
      best_ = {gain, angle};
  }

  double start_, longest_step_;
  std::array<double, kMaxStops> stops_{};  ///< 0: none
  int stops_count_ = 0;
  Point before_{};  ///< first point of the last step
  Crossing best_;
};

}  // namespace voxtouch::coupling::design
