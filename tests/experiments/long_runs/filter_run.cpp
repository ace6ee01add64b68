#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "core/coupling/running_coupling.hpp"
#include "tests/experiments/long_runs/long_runs.hpp"
#include "tests/support/coupling_models/pt2.hpp"
#include "tests/support/loop_rig/loop_rig.hpp"

namespace voxtouch::long_runs {
namespace {

constexpr double kT = 1e-3, kGain = 0.75;
constexpr std::uint64_t kSettled = 3000;  ///< samples; 94 filter times of 5 Hz

coupling::CouplingSpec filter(double hz, double d) {
  coupling::CouplingSpec spec;
  spec.cutoff_hz = hz, spec.damping_ratio = d, spec.gain = kGain;
  return spec;
}

coupling::CouplingInput push(double x) {
  return {{{x, -x, 0.5 * x}, {0.01 * x, 0, -0.02 * x}}, 1000};
}

/// Output of the filter with d = 1 and K = 1 in sample `n` (from 0) of a step that begins in sample
/// 0, from the double pole of its trapezoid rule. With g = w0 T / 2, p = (1 - g) / (1 + g), c = 2 g
/// / (1 + g)^2 and N = [1 1; -1 -1], the state's deviation is p^n (1 + n c N / p) times the first
/// one.
double step_response(long double g, std::uint64_t n) {
  const long double c = g / ((1 + g) * (1 + g));  // (y, v) of sample 0 is (g c, c)
  const long double a = g * c - 1, b = c;
  if (n == 0)
    return static_cast<double>(1 + a);
  const long double log_p = g < 1 ? std::log1p(-2 * g / (1 + g)) : std::log1p(-2 / (1 + g));
  const auto power = [&](std::uint64_t m) {
    return (g > 1 && m % 2 ? -1.0L : 1.0L) * std::exp(static_cast<long double>(m) * log_p);
  };
  return static_cast<double>(1 + power(n) * a +
                             static_cast<long double>(n) * power(n - 1) * 2 * c * (a + b));
}

/// Reports the progress at every hundredth.
class Teller {
 public:
  Teller(const Progress& progress, std::uint64_t all)
      : progress_(progress),
        all_(all),
        every_(std::max<std::uint64_t>(all / 100, 1)) {}
  void count(std::uint64_t n = 1) {
    done_ += n;
    if (!progress_ || done_ < next_)
      return;
    progress_(done_, all_);
    next_ += every_;
  }

 private:
  const Progress& progress_;
  std::uint64_t all_, every_, done_ = 0, next_ = 0;
};

/// A constant contact: the error of all samples after the transient, and of the last tenth.
void hold(const FilterRunOptions& ask, Teller& teller, Findings& out) {
  coupling::ShapingFilter coupling(filter(5.0, 1.0), kT);
  double worst = 0.0, first_s = 0.0, last_s = 0.0, last_tenth = 0.0;
  std::uint64_t n = 0;
  for (int tenth = 1; tenth <= 10; ++tenth) {
    const double begin = thread_seconds();
    last_tenth = 0.0;
    for (const std::uint64_t until = ask.steps / 10 * static_cast<std::uint64_t>(tenth);
         n < until;) {
      const std::uint64_t piece = std::min<std::uint64_t>(until - n, 100'000);
      for (std::uint64_t i = 0; i < piece; ++i, ++n) {
        const Wrench y = coupling.step({push(1.0).contact});
        const double error = std::max({std::abs(y.force.x() - kGain), std::abs(y.force.y() + kGain),
                                       std::abs(y.torque.z() + 0.02 * kGain)});
        if (n > kSettled)
          last_tenth = std::max(last_tenth, error);
      }
      teller.count(piece);
    }
    worst = std::max(worst, last_tenth);
    (tenth == 1 ? first_s : last_s) = thread_seconds() - begin;
  }
  out.slow_down = last_s / first_s;
  out.lines.push_back(fmt::format(
      "held contact, {} samples: error {:.2g} K, in the last tenth {:.2g} K; {:.1f} ns a sample", n,
      worst / kGain, last_tenth / kGain, last_s / static_cast<double>(ask.steps / 10) * 1e9));
  if (!(worst < 1e-14 * kGain))
    out.faults.push_back(fmt::format("a held contact is off by {:.3g} K", worst / kGain));
}

void respond(const FilterRunOptions& ask, Teller& teller, Findings& out) {
  constexpr double kAngles[] = {1e-6, 1e-4, 1e-2, 0.5, 3.0, 3.3, 30.0, 1000.0};
  const std::uint64_t steps = ask.steps / 10 / std::size(kAngles);
  double worst = 0.0;
  for (const double angle : kAngles) {
    coupling_models::Pt2 pt2(angle / kT, 1.0, 1.0);
    std::uint64_t next = 0;
    for (std::uint64_t n = 0; n < steps; ++n) {
      const double y = pt2.step(1.0, kT);
      if (n != next && n + 1 != steps)
        continue;
      next = n + 1 + n / 16;
      const double error = std::abs(y - step_response(0.5L * angle, n));
      worst = std::max(worst, error);
      if (!(error <= 1e-12))
        return out.faults.push_back(
            fmt::format("w0 T = {}: sample {} is off by {:.3g} K", angle, n, error));
    }
    teller.count(steps);
  }
  out.lines.push_back(fmt::format(
      "step responses, w0 T = 1e-6 to 1000, {} samples each: off the closed form by {:.2g} K",
      steps, worst));
}

/// Periods of an unreliable clock.
double period(std::mt19937_64& random) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                   kInf = std::numeric_limits<double>::infinity();
  constexpr double kBad[] = {0.0, -kT, -10.0, kNan, kInf, -kInf, 10.0, 1e-9, 0.02, 7e-3};
  const std::uint64_t bits = random();
  if (bits % 16 == 0)
    return kBad[(bits >> 8) % std::size(kBad)];
  return kT * (0.2 + 4.8 * static_cast<double>(bits >> 11) * 0x1p-53);
}

void disturb(const FilterRunOptions& ask, Teller& teller, Findings& out) {
  std::mt19937_64 random(ask.seed);
  const coupling::CouplingSpec spec = filter(30.0, 0.577);
  coupling::RunningCoupling coupling(spec, {}, kT);
  coupling.step({}, kT);
  const double most_step = 3.0 * kGain * coupling::cutoff_rad_per_s(spec) * 5.0 * kT;
  double u = 0.0, peak = 0.0, steepest = 0.0, before = 0.0;
  const std::uint64_t steps = ask.steps / 10;
  for (std::uint64_t n = 0; n < steps; ++n) {
    if (random() % 8 == 0)
      u = 2.0 * static_cast<double>(random() >> 11) * 0x1p-53 - 1.0;
    const double y = coupling.step(push(u), period(random)).wrench.force.x();
    if (!std::isfinite(y))
      return out.faults.push_back(fmt::format("sample {} of changing periods is no number", n));
    peak = std::max(peak, std::abs(y)), steepest = std::max(steepest, std::abs(y - before));
    before = y;
    if (n % 4096 == 0)
      teller.count(4096);
  }
  if (!(peak <= 2.0 * kGain))
    out.faults.push_back(
        fmt::format("changing periods give {:.3g} K of a contact of 1", peak / kGain));
  if (!(steepest <= most_step))
    out.faults.push_back(fmt::format("changing periods give a step of {:.3g} N", steepest));
  out.lines.push_back(
      fmt::format("changing periods, {} samples, {} of them bad: peak {:.3f} K (limit 2), largest "
                  "step {:.3f} N (limit {:.2f})",
                  steps, coupling.counters().faults, peak / kGain, steepest, most_step));
  Wrench y;
  for (std::uint64_t n = 0; n < kSettled; ++n)
    y = coupling.step(push(1.0), kT).wrench;
  const double error = std::abs(y.force.x() - kGain);
  if (!(error <= 1e-14 * kGain))
    out.faults.push_back(
        fmt::format("afterwards a held contact is off by {:.3g} K", error / kGain));
  for (std::uint64_t n = 0; n < 60'000; ++n)
    y = coupling.step({}, kT).wrench;
  if (!y.zero())
    out.faults.push_back("a minute after the release there is still force");
}

}  // namespace

Findings run_filter(const FilterRunOptions& ask, const Progress& progress) {
  Findings out;
  Teller teller(progress, ask.steps + ask.steps / 5);
  const Memory before = memory_in_use();
  hold(ask, teller, out);
  respond(ask, teller, out);
  disturb(ask, teller, out);
  const Memory after = memory_in_use();
  out.resident_growth = after.resident - before.resident,
  out.heap_growth = after.heap - before.heap;
  return out;
}

}  // namespace voxtouch::long_runs
