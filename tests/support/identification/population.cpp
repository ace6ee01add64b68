#include "tests/support/identification/population.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace voxtouch::testing {
namespace {

namespace id = identification;

constexpr double kForceRatio = 0.2;
constexpr std::size_t kMostSamples = 400'000;

double between(std::mt19937_64& r, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(r);
}
double log_between(std::mt19937_64& r, double low, double high) {
  return low * std::pow(high / low, between(r, 0.0, 1.0));
}

}  // namespace

std::array<AxisTruth, 3> random_device(std::mt19937_64& r, Family family) {
  AxisTruth common;
  common.rate_hz = log_between(r, 500.0, 4000.0);
  common.delay_s = log_between(r, 0.2e-3, 5e-3);
  common.encoder_step_m = log_between(r, 0.5e-6, 0.1e-3);
  common.lag_s = between(r, 0.0, 1.0) < 0.5 ? 0.0 : log_between(r, 0.2e-3, 3e-3);
  const double mass = log_between(r, 0.03, 15.0);
  common.max_force_n = mass < 1.0 ? log_between(r, 3.0, 40.0) : log_between(r, 10.0, 200.0);
  std::array<AxisTruth, 3> out;
  for (AxisTruth& t : out) {
    t = common;
    t.mass_kg = std::clamp(mass * between(r, 0.6, 1.4), 0.03, 15.0);
    t.viscous_ns_per_m = between(r, 0.0, 5.0);
    const double friction = between(r, 0.02, 0.6) * kForceRatio * t.max_force_n,
                 part = between(r, 0.0, 0.4);
    t.coulomb_n = friction * (1.0 - part);
    t.bias_n = friction * part * (between(r, 0.0, 1.0) < 0.5 ? -1.0 : 1.0);
    if (family == Family::kStribeck)
      t.stribeck = 0.5;
    if (family != Family::kMode)
      continue;
    t.mode_hz = log_between(r, 25.0, 180.0);
    t.mode_damping = log_between(r, 0.01, 0.1);
    t.mode_mass_ratio = between(r, 0.1, 0.5);
    t.encoder_at_far_mass = between(r, 0.0, 1.0) < 0.3;
  }
  return out;
}

double AxisRun::reserve() const {
  return (allowed_force_n - truth.coulomb_n - std::abs(truth.bias_n)) / truth.mass_kg;
}

AxisRun identify_axis(const AxisTruth& truth, std::uint64_t seed) {
  AxisRun out{.truth = truth, .figures = {}, .allowed_force_n = kForceRatio * truth.max_force_n};
  IdentifiedAxis device(truth, seed);
  id::AxisExcitation excitation;
  excitation.start({.period_s = 1.0 / truth.rate_hz, .allowed_force_n = out.allowed_force_n});
  for (std::size_t k = 0; k < kMostSamples && !excitation.finished(); ++k) {
    const AxisSample s = device.next();
    const double force = excitation.step(s.time_s, s.position_m);
    out.largest_force_n = std::max(out.largest_force_n, std::abs(force));
    device.command(force);
    if (!excitation.waiting())
      continue;
    const id::FitResult result = id::fit(excitation.fit_input());
    if (excitation.current() == id::Step::kFitAll)
      out.figures = result.figures;
    excitation.resume(result.model);
  }
  if (excitation.outcome()) {
    out.figures.outcome = *excitation.outcome();
    out.figures.break_away_n = excitation.break_away_n();
  }
  out.encoder_step_m = id::encoder_step(excitation.record());
  return out;
}

void Counts::add(const AxisRun& run, double mass_limit) {
  const AxisTruth& t = run.truth;
  const id::AxisFigures& f = run.figures;
  ++axes;
  stopped += id::ends_session(f.outcome);
  if (f.outcome != id::Outcome::kMeasured)
    return;
  ++measured;
  const std::array error{f.mass_kg.value - t.mass_kg, f.viscous_ns_per_m.value - t.viscous_ns_per_m,
                         f.coulomb_n.value - t.coulomb_n, f.bias_n.value - t.bias_n,
                         f.delay_s.value - t.mean_delay_s()};
  const std::array half{f.mass_kg.half_width, f.viscous_ns_per_m.half_width, f.coulomb_n.half_width,
                        f.bias_n.half_width, f.delay_s.half_width};
  mass += std::abs(error[0]) <= mass_limit * t.mass_kg;
  viscous += std::abs(error[1]) <= std::max(0.1, 0.1 * t.viscous_ns_per_m);
  coulomb += std::abs(error[2]) <= std::max(0.02, 0.1 * t.coulomb_n);
  step += std::abs(run.encoder_step_m / t.encoder_step_m - 1.0) < 1e-6;
  if (run.reserve() >= 1.0) {
    ++reserve;
    delay += std::abs(error[4]) <= std::max(1e-4, 0.1 / t.rate_hz);
  }
  for (std::size_t k = 0; k < 5; ++k) {
    covered[k] += std::abs(error[k]) <= half[k];
    half_widths[k].push_back(k == 0 ? half[0] / t.mass_kg : half[k]);
  }
  if (t.mode_hz <= 0.0) {
    false_alarms += f.mode.found;
    return;
  }
  ++modes;
  if (t.mode_hz >= 90.0)
    return;
  ++low_modes;
  low_found += f.mode.found && std::abs(f.mode.frequency_hz.value / t.mode_hz - 1.0) < 0.1;
}

double Counts::median_half_width(std::size_t figure) const {
  std::vector<double> sorted = half_widths[figure];
  if (sorted.empty())
    return 0.0;
  std::ranges::sort(sorted);
  return sorted[sorted.size() / 2];
}

std::string to_text(const Counts& c) {
  const auto ratio = [](int part, int all) { return all > 0 ? 100.0 * part / all : 0.0; };
  std::string out = fmt::format("axes {}, measured {} ({:.1f} %)\n", c.axes, c.measured,
                                ratio(c.measured, c.axes));
  out += fmt::format(
      "within the limit: mass {:.1f} %, viscous {:.1f} %, Coulomb {:.1f} %, encoder step {:.1f} "
      "%\n",
      ratio(c.mass, c.measured), ratio(c.viscous, c.measured), ratio(c.coulomb, c.measured),
      ratio(c.step, c.measured));
  out += fmt::format("delay, reserve of 1 m/s2 and more: {:.1f} % of {}\n",
                     ratio(c.delay, c.reserve), c.reserve);
  out += fmt::format(
      "intervals hold the truth: mass {:.1f} %, viscous {:.1f} %, Coulomb {:.1f} %, bias {:.1f} %, "
      "delay {:.1f} %\n",
      ratio(c.covered[0], c.measured), ratio(c.covered[1], c.measured),
      ratio(c.covered[2], c.measured), ratio(c.covered[3], c.measured),
      ratio(c.covered[4], c.measured));
  out += fmt::format(
      "median half width: mass {:.2f} %, viscous {:.3f} Ns/m, Coulomb {:.2f} mN, bias {:.2f} mN, "
      "delay {:.3f} ms\n",
      1e2 * c.median_half_width(0), c.median_half_width(1), 1e3 * c.median_half_width(2),
      1e3 * c.median_half_width(3), 1e3 * c.median_half_width(4));
  out += fmt::format("modes below 90 Hz found {} of {}, false alarms {} of {}\n", c.low_found,
                     c.low_modes, c.false_alarms, c.measured - c.modes);
  return out;
}

FaultRun run_fault(const AxisTruth& truth, AxisFault fault, double at_s, std::uint64_t seed) {
  FaultRun out;
  const double allowed = kForceRatio * truth.max_force_n, period = 1.0 / truth.rate_hz;
  out.time_limit_s = 2.4 * period + truth.mean_delay_s() + 4e-3;
  IdentifiedAxis device(truth, seed);
  device.fail(fault, at_s);
  id::AxisExcitation excitation;
  const id::AxisLimits limits{.period_s = period, .allowed_force_n = allowed};
  excitation.start(limits);
  double left_s = -1.0, zero_s = -1.0, after_s = 0.0, energy_before = 0.0;
  const double start = device.position();
  for (std::size_t k = 0; k < kMostSamples; ++k) {
    const AxisSample s = device.next();
    const double force = excitation.step(s.time_s, s.position_m);
    out.over_force = out.over_force || std::abs(force) > allowed * (1.0 + 1e-12);
    device.command(force);
    if (device.time() < at_s)
      energy_before = device.energy_given();
    const bool outside = std::abs(device.position() - start) > limits.box_m + truth.encoder_step_m;
    if (left_s < 0.0 && outside)
      left_s = device.time();
    if (device.applies_force())
      zero_s = -1.0;
    else if (zero_s < 0.0)
      zero_s = device.time();
    if (excitation.finished()) {
      if (after_s == 0.0) {
        after_s = device.time();
        out.energy_j = device.energy_given() - energy_before;
      }
      if (device.time() > after_s + 0.1)
        break;
      continue;
    }
    if (!excitation.waiting())
      continue;
    excitation.resume(id::fit(excitation.fit_input()).model);
  }
  if (excitation.outcome()) {
    out.outcome = *excitation.outcome();
    out.stopped = true;
  }
  if (left_s >= 0.0 && out.stopped) {
    out.left_bounds = true;
    out.time_to_zero_s = zero_s < 0.0 ? 1.0 : std::max(0.0, zero_s - left_s);
  }
  return out;
}

}  // namespace voxtouch::testing
