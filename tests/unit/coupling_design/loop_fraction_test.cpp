/// The loop as a fraction over an arc: its value, and that the bound of an arc holds all of its
/// points.
#include <gtest/gtest.h>

#include <random>

#include "core/coupling/design/loop_fraction.hpp"
#include "core/coupling/design/loop_response.hpp"

namespace voxtouch::testing {
namespace {

using namespace coupling::design;
using Law = LoopController::Law;

struct RandomLoop {
  LoopPlant plant;
  LoopController law;
};

/// Every law, both velocities, with and without a hand, a lag, damping and a fraction of delay.
std::vector<RandomLoop> random_loops() {
  std::mt19937 random(3);
  const auto draw = [&](double low, double high) {
    return low * std::pow(high / low, std::uniform_real_distribution<>()(random));
  };
  std::vector<RandomLoop> out;
  for (int i = 0; i < 96; ++i) {
    LoopPlant p{.mass = draw(0.03, 15), .damping = draw(0.003, 30), .period_s = draw(1e-4, 4e-3)};
    p.delay_s = (i % 3) * 0.7 * p.period_s;
    p.effort_lag_s = i % 2 == 0 ? draw(1e-3, 5e-3) : 0.0;
    if (i % 4 < 2) {
      p.hand_mass = draw(0.02, 2);
      p.hand_damping = draw(0.5, 30);
      p.hand_stiffness = draw(20, 800);
    }
    LoopController c;
    c.law = static_cast<Law>(i / 2 % 3);
    c.w0_rad_per_s = draw(30, 0.5 / p.period_s);
    c.damping_ratio = draw(0.5, 2);
    c.gain = draw(0.1, 2);
    c.stiffness = draw(50, 5000);
    c.damping = draw(0.1, 20);
    c.injected_damping = i % 5 == 0 ? 0.0 : draw(0.1, 50);
    c.velocity_filter_rad_per_s = draw(50, 1500);
    c.velocity_window = i / 3 % 3 * 2;
    out.push_back({p, c});
  }
  return out;
}

TEST(LoopFraction, EqualsTheResponseOfTheLinearCertificate) {
  for (const RandomLoop& one : random_loops()) {
    const LoopResponse response(one.plant, one.law);
    const LoopOverArc loop = loop_over_arc(one.plant, one.law);
    for (const double angle : {1e-6, 1e-4, 0.01, 0.1, 0.7, 2.0, 3.1}) {
      const Phasor phasor(angle);
      const Complex expected = response.of(response.damped_plant(phasor), phasor);
      const Arc point(angle, 0.0);
      const Complex value = value_in_the_middle(loop(point), point);
      EXPECT_LT(std::abs(value - expected), 1e-9 * std::abs(expected)) << angle;
    }
  }
}

/// How far a point of the arc may be from the straight line of its model.
void expect_enclosed(const TaylorModel& arc, const TaylorModel& point, double x, double scale) {
  const double rounding = 1e-12 * scale;
  EXPECT_LE(std::abs(arc.value + arc.slope * x - point.value), arc.rest + rounding);
}

TEST(LoopFraction, AnArcEnclosesAllOfItsPoints) {
  for (const RandomLoop& one : random_loops()) {
    const LoopOverArc loop = loop_over_arc(one.plant, one.law);
    for (const double middle : {1e-5, 1e-3, 0.03, 0.5, 1.5, 2.5})
      for (const double half : {middle, 0.3 * middle, 0.01 * middle}) {
        if (middle + half > 3.14)
          continue;
        const LoopFraction all = loop(Arc(middle, half));
        const double top = std::abs(all.numerator.even.value) + std::abs(all.numerator.odd.value);
        const double bottom =
            std::abs(all.denominator.even.value) + std::abs(all.denominator.odd.value);
        for (double part = -1.0; part <= 1.0; part += 0.125) {
          const double x = part * half;
          if (!(middle + x > 0.0))
            continue;
          const LoopFraction at = loop(Arc(middle + x, 0.0));
          expect_enclosed(all.numerator.even, at.numerator.even, x, top);
          expect_enclosed(all.numerator.odd, at.numerator.odd, x, top);
          expect_enclosed(all.denominator.even, at.denominator.even, x, bottom);
          expect_enclosed(all.denominator.odd, at.denominator.odd, x, bottom);
        }
      }
  }
}

/// d^2/da^2 of sin(k a)/(2 sin(a/2)) by differences, against its bound.
TEST(LoopFraction, TheBoundOfADelaysCurvatureHolds) {
  const auto kernel = [](int k, double a) { return std::sin(k * a) / (2.0 * std::sin(0.5 * a)); };
  for (const int k : {1, 2, 5, 20, 60})
    for (const double from : {0.01, 0.1, 0.5, 2.0})
      for (double a = from; a < 3.14; a += 0.013) {
        const double h = 1e-4;
        const double curvature =
            (kernel(k, a + h) - 2.0 * kernel(k, a) + kernel(k, a - h)) / (h * h);
        EXPECT_LE(std::abs(curvature), 1.001 * kernel_curvature(k, from) + 1e-3) << k << " " << a;
      }
}

}  // namespace
}  // namespace voxtouch::testing
