// The estimator on motion that follows from known figures.
#include "core/identification/output_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace voxtouch::identification {
namespace {

constexpr double kPeriodS = 1e-3;

/// Exact motion of a mass with viscous friction under forces that arrive after a delay of whole
/// steps of
/// 10 us; each stroke moves in one direction. Friction is a constant force against the direction.
AxisRecord motion(const AxisModel& truth, double step_m) {
  constexpr double kFineS = 1e-5;
  AxisRecord record;
  record.reserve(20000);
  const auto delay = static_cast<std::size_t>(std::lround(truth.delay_s / kFineS));
  for (int stroke = 0; stroke < 8; ++stroke) {
    const int direction = stroke % 2 == 0 ? 1 : -1;
    double x = 0.0, v = direction * 0.05;
    std::vector<double> forces;
    for (std::size_t fine = 0; fine < 50000; ++fine) {
      const double t = kFineS * static_cast<double>(fine);
      if (fine % 100 == 0) {
        double tones = 0.0;
        for (const double f : {3.0, 7.0, 16.0, 35.0})
          tones += 0.1 * truth.mass_kg * f * std::cos(2.0 * std::numbers::pi * f * t + f + stroke);
        forces.push_back(direction * (truth.coulomb_n + 0.05 * truth.viscous_ns_per_m) -
                         truth.bias_n + tones);
        record.add({.time_s = stroke + t,
                    .position_m = step_m > 0.0 ? step_m * std::round(x / step_m) : x,
                    .force_n = forces.back(),
                    .segment = static_cast<std::int16_t>(stroke),
                    .direction = static_cast<std::int8_t>(direction),
                    .part = Part::kStroke});
      }
      const double u = fine >= delay ? forces[(fine - delay) / 100] : forces[0];
      const double total = u + truth.bias_n - direction * truth.coulomb_n;
      const double half = 0.5 * kFineS * truth.viscous_ns_per_m / truth.mass_kg;
      const double before = v;
      v = (v * (1.0 - half) + kFineS * total / truth.mass_kg) / (1.0 + half);
      x += 0.5 * kFineS * (before + v);
    }
  }
  return record;
}

constexpr AxisModel kTruth{
    .mass_kg = 0.4, .viscous_ns_per_m = 0.8, .coulomb_n = 0.3, .bias_n = 0.1, .delay_s = 2.4e-3};

Fit fitted(const AxisRecord& record, const FitOptions& options) {
  return fit_output_error(record, stroke_windows(record, Part::kStroke, {}), options);
}

TEST(OutputError, FindsTheFiguresOfAnExactMotion) {
  const Fit fit = fitted(motion(kTruth, 0.0), {.start = {}, .longest_period_s = kPeriodS});
  ASSERT_TRUE(fit.converged);
  EXPECT_NEAR(fit.figures.mass_kg.value, 0.4, 1e-5);
  EXPECT_NEAR(fit.figures.viscous_ns_per_m.value, 0.8, 1e-4);
  EXPECT_NEAR(fit.figures.coulomb_n.value, 0.3, 1e-5);
  EXPECT_NEAR(fit.figures.bias_n.value, 0.1, 1e-5);
  EXPECT_NEAR(fit.figures.delay_s.value, 2.4e-3, 1e-6);
}

TEST(OutputError, IntervalsHoldTheTruthWithEncoderSteps) {
  const Fit fit = fitted(motion(kTruth, 5e-5), {.start = {}, .longest_period_s = kPeriodS});
  ASSERT_TRUE(fit.converged);
  EXPECT_NEAR(fit.figures.mass_kg.value, 0.4, fit.figures.mass_kg.half_width);
  EXPECT_NEAR(fit.figures.delay_s.value, 2.4e-3, fit.figures.delay_s.half_width);
  EXPECT_LT(fit.figures.mass_kg.half_width, 0.02 * 0.4);
}

TEST(OutputError, KnownFrictionLeavesMassAndDelay) {
  FitOptions options{.start = kTruth, .longest_period_s = kPeriodS, .friction_known = true};
  options.start.mass_kg = 0.0;
  const Fit fit = fitted(motion(kTruth, 0.0), options);
  ASSERT_TRUE(fit.converged);
  EXPECT_NEAR(fit.figures.mass_kg.value, 0.4, 1e-4);
}

TEST(Windows, CutStrokesAtMotionReversals) {
  AxisRecord record;
  record.reserve(2000);
  for (int i = 0; i < 1000; ++i) {
    const double t = 1e-3 * i;
    const double x = t < 0.6 ? 0.05 * t : 0.03 - 0.05 * (t - 0.6);  // reverses at 0.6 s
    record.add({.time_s = t, .position_m = x, .segment = 1, .direction = 1, .part = Part::kStroke});
  }
  const auto windows = stroke_windows(record, Part::kStroke, {.encoder_step_m = 1e-5});
  ASSERT_FALSE(windows.empty());
  for (const Window& w : windows)
    EXPECT_LE(record.entries()[w.end - 1].time_s, 0.61);
}

TEST(Windows, EncoderStepIsTheCommonIncrement) {
  AxisRecord record;
  record.reserve(100);
  for (const int steps : {0, 6, 15, 12, 20, 20, 33, 27})
    record.add({.position_m = 1.3e-6 * steps});
  EXPECT_NEAR(encoder_step(record), 1.3e-6, 1e-12);
}

}  // namespace
}  // namespace voxtouch::identification
