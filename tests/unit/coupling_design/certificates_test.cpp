#include "core/coupling/design/certificates.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <complex>
#include <limits>
#include <vector>

#include "core/coupling/design/sampled_loop.hpp"
#include "tests/support/coupling_models/pt2.hpp"
#include "tests/unit/coupling_design/support.hpp"

namespace voxtouch::coupling::design {
namespace certificates_test {

using testing::loop_cases;
using testing::Random;
using Law = LoopController::Law;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRatios[] = {0.05,  0.2, 0.577, 0.7071067811865476, 0.866, 0.999, 1.0,
                              1.001, 2.0, 10.0};

/// Impulse response of the continuous filter with w0 = 1.
double impulse(double d, double t) {
  if (d == 1.0)
    return t * std::exp(-t);
  const double beta = std::sqrt(std::abs(1.0 - d * d));
  if (d < 1.0)
    return std::exp(-d * t) * std::sin(beta * t) / beta;
  return 0.5 * (std::exp((beta - d) * t) - std::exp(-(beta + d) * t)) / beta;
}

TEST(FilterShape, ClosedFormsEqualBruteForceIntegration) {
  for (const double d : kRatios) {
    // Simpson over pieces that end at sign changes of h.
    const double wave = d < 0.9 ? std::numbers::pi / std::sqrt(1.0 - d * d) : 1.0;
    const double end = 40.0 * (d < 1.0 ? 1.0 / d : 2.0 * d);
    double overshoot = 0.0, lag = 0.0;
    for (double from = 0.0; from < end; from += wave) {
      constexpr int kPieces = 200;
      for (int i = 0; i <= kPieces; ++i) {
        const double t = from + wave * i / kPieces, h = std::abs(impulse(d, t));
        const double weight = (i == 0 || i == kPieces ? 1.0
                               : i % 2                ? 4.0
                                                      : 2.0) *
                              wave / (3.0 * kPieces);
        overshoot += weight * h, lag += weight * t * h;
      }
    }
    EXPECT_NEAR(overshoot_shape(d) / overshoot, 1.0, 2e-7) << d;
    EXPECT_NEAR(lag_shape(d) / lag, 1.0, 2e-7) << d;
  }
}

TEST(FilterShape, HasThePublishedValues) {
  const std::array<double, 3> rows[] = {
      {.577, 2.49, 1.24}, {.707, 1.96, 1.09}, {.866, 1.80, 1.01}, {1.0, 2.0, 1.0}, {3.0, 6.0, 1.0}};
  for (const auto& [d, lag, overshoot] : rows) {
    EXPECT_NEAR(lag_shape(d), lag, 0.005) << d;
    EXPECT_NEAR(overshoot_shape(d), overshoot, 0.005) << d;
  }
  EXPECT_NEAR(overshoot_shape(.866), 1.009, 0.0005);
  EXPECT_NEAR(lag_shape(1.0 - 1e-12), 2.0, 1e-9) << "no jump at d = 1";
}

/// An impulse so hard that the filter's coming to rest below 1e-12 cuts nothing off.
constexpr double kHit = 1e12;

TEST(FilterShape, SampledSumsAreThoseOfTheRingsFilter) {
  for (const double d : kRatios) {
    for (const double angle : {2e-3, 0.0314, 0.314, 0.6, 1.5, 3.0}) {
      const double period = 1e-3, w0 = angle / period;
      coupling_models::Pt2 filter(w0, d, 1.0);
      const int samples =
          static_cast<int>(60.0 * (d < 1.0 ? 1.0 / d : 2.0 * d) / angle * (1.0 + angle * angle)) +
          100;
      double overshoot = 0.0, lag = 0.0;
      for (int i = 0; i < samples; ++i) {
        const double h = std::abs(filter.step(i == 0 ? kHit : 0.0, period)) / kHit;
        overshoot += h, lag += angle * i * h;
      }
      const FilterShape shape = sampled_filter_shape(w0, d, period);
      EXPECT_NEAR(shape.overshoot / overshoot, 1.0, 1e-8) << d << " " << angle;
      EXPECT_NEAR(shape.lag / lag, 1.0, 1e-8) << d << " " << angle;
      EXPECT_GE(shape.lag, lag_shape(d) * (1.0 - 1e-9))
          << "the continuous shape is too small: " << d << " " << angle;
    }
  }
}

TEST(FilterShape, BoundForVeryLongResponsesLiesAboveTheSums) {
  for (const double d : {0.005, 0.019, 0.5}) {
    for (const double angle : {9e-4, 0.03, 0.3, 1.5}) {
      if (d == 0.5 && angle > 1e-3)
        continue;  // summed
      coupling_models::Pt2 filter(angle / 1e-3, d, 1.0);
      const int samples = static_cast<int>(40.0 / (d * angle) * (1.0 + angle * angle)) + 100;
      double overshoot = 0.0, lag = 0.0;
      for (int i = 0; i < samples; ++i) {
        const double h = std::abs(filter.step(i == 0 ? kHit : 0.0, 1e-3)) / kHit;
        overshoot += h, lag += angle * i * h;
      }
      const FilterShape shape = sampled_filter_shape(angle / 1e-3, d, 1e-3);
      EXPECT_GE(shape.overshoot, overshoot * (1.0 - 1e-12)) << d << " " << angle;
      EXPECT_GE(shape.lag, lag * (1.0 - 1e-12)) << d << " " << angle;
    }
  }
}

LoopTiming ideal(double period_s, double delay_s) {
  return {.period_s = period_s, .delay_s = delay_s, .jitter = 0.0, .consecutive_losses = 0};
}

TEST(RuleP, IsTheFormula) {
  // 50 Hz, d = 1: taps never negative, so everything is known. K k {1.2 * 2/w0 + td + ta + 1.5
  // * 1.2 T} = b.
  const double w0 = 100.0 * std::numbers::pi;
  const LoopTiming timing{
      .period_s = 1e-3, .delay_s = 1.5e-3, .jitter = 0.2, .consecutive_losses = 1};
  const double lag = 1.2 * 2.0 / w0 + 1.5e-3 + 0.5e-3 + 1.5 * 1.2e-3;
  EXPECT_NEAR(passive_stiffness_filter(w0, 1.0, 0.5, timing, 0.5e-3), 0.5 / lag, 1e-9);
  EXPECT_NEAR(passive_stiffness_filter(kInfinity, 0.3, 0.5, timing, 0.5e-3),
              0.5 / (lag - 1.2 * 2.0 / w0), 1e-9);
  EXPECT_EQ(passive_stiffness_filter(w0, 0.7, 0.0, timing, 0.0), 0.0);
}

TEST(RuleP, NeverExceedsTheLimitOfAnyPassiveHand) {
  const std::uint64_t seed = 77;
  Random random(seed);
  std::vector<double> released, level, linear, lossy;
  for (int i = 0; i < 6000; ++i) {
    const bool free = i % 2 == 0;
    LoopPlant p = testing::random_plant(random, free);
    p.hand_damping = 0.0;  // the worst of the passive: it takes nothing
    const LoopController c = testing::random_filter(random);
    const double exact = critical_stiffness(p, c).stiffness;
    if (!free && exact == 0.0)
      p.hand_damping = 1e-6;
    const double limit = critical_stiffness(p, c).stiffness;
    const double rule = passive_stiffness_filter(c.w0_rad_per_s, c.damping_ratio, p.damping,
                                                 ideal(p.period_s, p.delay_s), p.effort_lag_s);
    ASSERT_LE(rule, limit * (1.0 + 1e-9))
        << "seed " << seed << " loop " << i << " w0 T " << c.w0_rad_per_s * p.period_s;
    ASSERT_GT(rule, 0.0);
    if (!free)
      continue;
    released.push_back(rule / limit);
    if (c.damping_ratio >= 0.866)
      level.push_back(rule / limit);
    linear.push_back(linear_passive_stiffness_filter(c.w0_rad_per_s, c.damping_ratio, p.damping,
                                                     ideal(p.period_s, p.delay_s), p.effort_lag_s) /
                     limit);
    LoopTiming timing = ideal(p.period_s, p.delay_s);
    timing.jitter = 0.2, timing.consecutive_losses = 2;
    lossy.push_back(passive_stiffness_filter(c.w0_rad_per_s, c.damping_ratio, p.damping, timing,
                                             p.effort_lag_s) /
                    limit);
  }
  const auto median = [](std::vector<double>& v) {
    std::nth_element(v.begin(), v.begin() + v.size() / 2, v.end());
    return v[v.size() / 2];
  };
  const double all = median(released), smooth = median(level), worst = median(lossy);
  std::printf(
      "fraction of the released device's exact limit, median: rule P %.3f (d >= .866: %.3f; 2 lost "
      "and jitter: %.3f), "
      "linear any-passive %.3f\n",
      all, smooth, worst, median(linear));
  RecordProperty("median_tightness", std::to_string(all));
  EXPECT_LE(worst, all);
}

TEST(LinearPassive, EqualsTheReference) {
  double worst = 0.0;
  int rows = 0;
  for (const auto& c : loop_cases()) {
    if (c["k_any_passive_human"].is_null() || c["B_inj"] != 0.0)
      continue;
    const double expected = c["k_any_passive_human"];
    const double found = linear_passive_stiffness_filter(c["w0"], c["d"], c["b"],
                                                         ideal(c["T"], c["delay"]), c["force_lag"]);
    // The reference's search is up to 1.6e-4 low if the largest lag is that at standstill.
    EXPECT_NEAR(found / expected, 1.0, 2e-4) << c["note"];
    worst = std::max(worst, std::abs(found / expected - 1.0));
    ++rows;
  }
  std::printf("linear any-passive limit: largest relative difference %.2g in %d rows\n", worst,
              rows);
  EXPECT_EQ(rows, 11);
}

TEST(LinearPassive, HasThePublishedComparison) {
  const double five = 10.0 * std::numbers::pi, d = 0.577;
  const LoopTiming stylus = ideal(1e-3, 1e-3), arm = ideal(1e-3, 5e-3);
  EXPECT_NEAR(linear_passive_stiffness_filter(five, d, 0.5, stylus, 0.0), 11.8, 0.05);
  EXPECT_NEAR(linear_passive_stiffness_filter(five, d, 30.0, arm, 0.0), 659.0, 1.0);
  EXPECT_NEAR(linear_passive_stiffness_filter(10.0 * five, d, 0.5, stylus, 0.0), 94.0, 0.5);
  EXPECT_NEAR(linear_passive_stiffness_filter(10.0 * five, d, 30.0, arm, 0.0), 3270.0, 5.0);
  EXPECT_NEAR(linear_passive_stiffness_filter(kInfinity, d, 0.5, stylus, 0.0),
              colgate_stiffness(0.5, 1e-3, 1), 1e-9);
}

TEST(LinearPassive, FindsTheSameMaximumAsADenseSearch) {
  Random random(9);
  for (int i = 0; i < 200; ++i) {
    const double period = 1e-3, w0 = random.log(1.0, 2500.0), d = random.log(0.01, 20.0);
    const int n = random.below(8);
    const double found = 1.0 / linear_passive_stiffness_filter(
                                   w0, d, 1.0, ideal(period, n * period), 0.0);  // a pure hold
    const auto lag = [&](double angle) {
      const std::complex<double> r(0.0, std::tan(0.5 * angle)), g = 0.5 * w0 * period;
      const auto h = g * g / (r * r + 2.0 * d * g * r + g * g);
      return -0.5 * period * (std::polar(1.0, -(n + 0.5) * angle) * h).imag() /
             std::sin(0.5 * angle);
    };
    double dense = 2.0 * d / w0 + (n + 0.5) * period;
    for (double angle = 1e-4; angle < std::numbers::pi; angle += 2e-4)
      dense = std::max(dense, lag(angle));
    for (double t = 0.5; t < 2.0; t += 2e-5)
      dense = std::max(dense, lag(std::min(3.14159, t * 2.0 * std::atan(0.5 * w0 * period))));
    ASSERT_GE(found, dense * (1.0 - 1e-12)) << i;
    ASSERT_LE(found, dense * (1.0 + 1e-4))
        << i << " w0 T " << w0 * period << " d " << d << " n " << n;
  }
}

TEST(LinearPassive, NoPassiveHandDestabilisesItsContact) {
  const std::uint64_t seed = 31;
  Random random(seed);
  double tightest = 0.0;
  for (int i = 0; i < 300; ++i) {
    const LoopPlant device = testing::random_plant(random, true);
    const LoopController c = testing::random_filter(random);
    const double limit = linear_passive_stiffness_filter(
        c.w0_rad_per_s, c.damping_ratio, device.damping, ideal(device.period_s, device.delay_s),
        device.effort_lag_s);
    double softest = critical_stiffness(device, c).stiffness;
    for (int hand = 0; hand < 60; ++hand) {
      LoopPlant p = device;
      p.hand_mass = random.log(1e-3, 1e3);
      p.hand_stiffness =
          (p.mass + p.hand_mass) * std::pow(random.log(0.05, 3.0) * c.w0_rad_per_s, 2);
      softest = std::min(softest, critical_stiffness(p, c).stiffness);
    }
    ASSERT_LE(limit, softest * (1.0 + 1e-6)) << "seed " << seed << " device " << i;
    tightest = std::max(tightest, limit / softest);
  }
  std::printf("linear any-passive limit / softest of 60 hands: up to %.4f\n", tightest);
  EXPECT_GT(tightest, 0.99);
}

TEST(Colgate, IsTheExactLimitOfAHeavySlowDevice) {
  EXPECT_DOUBLE_EQ(colgate_stiffness(0.5, 1e-3, 1), 0.5 / 1.5e-3);
  EXPECT_NEAR(colgate_stiffness(30.0, 1e-3, 5), 5450.0, 5.0);
  const LoopPlant heavy{.mass = 1e3, .damping = 0.5, .period_s = 1e-3, .delay_s = 1e-3};
  EXPECT_NEAR(
      critical_stiffness(heavy, {.law = Law::kDirect}).stiffness / colgate_stiffness(0.5, 1e-3, 1),
      1.0, 1e-4);
}

TEST(LimitCycle, FrictionIsHalfAStepOfTheForce) {
  EXPECT_DOUBLE_EQ(limit_cycle_friction(1.0, 1000.0, 3e-5), 0.015);
  EXPECT_DOUBLE_EQ(limit_cycle_friction(0.577, 1000.0, 3e-5), 0.015 * overshoot_shape(0.577));
}

}  // namespace certificates_test
}  // namespace voxtouch::coupling::design
