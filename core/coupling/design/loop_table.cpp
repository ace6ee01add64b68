#include "core/coupling/design/loop_table.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

namespace voxtouch::coupling::design {
namespace {

constexpr std::size_t kPoints = 320;
/// Lowest frequency [rad/s]. Loops that become unstable below it have no useful stiffness.
constexpr double kLowest = 0.05;

std::vector<DecayingPhasor> grid(double period_s, double damping_ratio) {
  std::vector<DecayingPhasor> out;
  const double lowest = kLowest * period_s,
               ratio = std::log(std::numbers::pi / lowest) / (kPoints - 1);
  for (std::size_t i = 0; i + 1 < kPoints; ++i)
    out.emplace_back(lowest * std::exp(ratio * static_cast<double>(i)), damping_ratio);
  out.emplace_back(std::numbers::pi, damping_ratio);
  return out;
}

}  // namespace

LoopTable::LoopTable(const std::vector<DesignCase>& cases,
                     std::span<const VelocityEstimate> velocities, LoopLimit limit) {
  for (const DesignCase& one : cases) {
    const double period = one.plant.period_s,
                 ratio = limit == LoopLimit::kStable ? 0.0 : one.least_damping_ratio;
    if (limit == LoopLimit::kDamped && ratio <= 0.0)
      continue;
    auto timing = std::ranges::find_if(timings_, [&](const Timing& t) {
      return t.period_s == period && t.damping_ratio == ratio;
    });
    if (timing == timings_.end())
      timing = timings_.insert(timing, timing_of(period, ratio, velocities));
    Case entry{static_cast<std::size_t>(timing - timings_.begin()), {}, {}, {}};
    entry.damped.resize(velocities.size());
    const LoopResponse plant(one.plant, {.law = LoopController::Law::kDirect});
    for (const DecayingPhasor& at : timing->grid)
      add(entry.plant, plant.damped_plant(at));
    for (std::size_t v = 0; v < velocities.size(); ++v)
      for (std::size_t i = 0; i < kPoints; ++i)
        add(entry.damped[v],
            Complex(entry.plant.re[i], entry.plant.im[i]) * timing->velocities[v][i]);
    entry.loop = entry.plant;
    cases_.push_back(std::move(entry));
  }
}

LoopTable::Timing LoopTable::timing_of(double period_s, double damping_ratio,
                                       std::span<const VelocityEstimate> velocities) {
  Timing out{period_s, damping_ratio, grid(period_s, damping_ratio), {}};
  for (const VelocityEstimate& one : velocities) {
    const VelocityResponse velocity(period_s, one.filter_rad_per_s(), one.window);
    std::ranges::transform(out.grid, std::back_inserter(out.velocities.emplace_back()), velocity);
  }
  return out;
}

void LoopTable::add(Response& to, const Complex& value) {
  to.re.push_back(value.real());
  to.im.push_back(value.imag());
}

void LoopTable::use(const LoopLaw& law) {
  std::vector<std::vector<Complex>> laws;
  for (const Timing& timing : timings_) {
    laws.emplace_back();
    for (const DecayingPhasor& at : timing.grid)
      laws.back().push_back(law(at, timing.period_s));
  }
  for (Case& one : cases_) {
    for (std::size_t i = 0; i < kPoints; ++i) {
      const Complex loop = laws[one.timing][i] * Complex(one.plant.re[i], one.plant.im[i]);
      one.loop.re[i] = loop.real(), one.loop.im[i] = loop.imag();
    }
  }
}

double LoopTable::critical(const Case& one, std::size_t velocity, double injected_damping,
                           const Bound* bound) {
  const bool damped = injected_damping > 0.0;
  const Response& unit = damped ? one.damped[velocity] : one.plant;
  const double b = damped ? injected_damping : 0.0;
  // L = loop / (1 + B unit). Its real and imaginary parts are computed times |1 + B unit|^2 > 0,
  // which avoids the divisions.
  const auto re = [&](std::size_t i) {
    return one.loop.re[i] * (1.0 + b * unit.re[i]) + one.loop.im[i] * b * unit.im[i];
  };
  const auto im = [&](std::size_t i) {
    return one.loop.im[i] * (1.0 + b * unit.re[i]) - one.loop.re[i] * b * unit.im[i];
  };
  const auto size = [&](std::size_t i) {
    const double x = 1.0 + b * unit.re[i], y = b * unit.im[i];
    return x * x + y * y;
  };
  double lowest = std::numeric_limits<double>::infinity();
  // Beyond -180 degrees at the lowest frequency: unstable from the start, or from a negligible
  // stiffness on.
  if (im(0) > 0.0 && re(0) < 0.0)
    return 0.0;
  for (std::size_t i = 1; i < kPoints; ++i) {
    const double before = im(i - 1), now = im(i);
    if ((before < 0.0) == (now < 0.0))
      continue;
    const double here = now / size(i), there = before / size(i - 1),
                 fraction = there / (there - here);
    const double crossing = (1.0 - fraction) * re(i - 1) / size(i - 1) + fraction * re(i) / size(i);
    const auto damper = [&] {
      return quotient(bound->whole * Complex(unit.re[i], unit.im[i]),
                      -1.0 / crossing * Complex(one.loop.re[i], one.loop.im[i]));
    };
    if (crossing < 0.0 && -1.0 / crossing < lowest &&
        (!bound || (-1.0 / crossing / bound->large_swing < bound->lowest &&
                    residual_damping(damper(), bound->fraction) <= bound->up_to)))
      lowest = -1.0 / crossing;
  }
  const double nyquist = re(kPoints - 1) / size(kPoints - 1);
  return nyquist < 0.0 ? std::min(lowest, -1.0 / nyquist) : lowest;
}

double LoopTable::critical(std::size_t velocity, double injected_damping, double enough,
                           double damping_force_ratio, double large_swing) {
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < cases_.size(); ++n) {
    const std::size_t c = n > first_ ? n : n == 0 ? first_ : n - 1;
    const Case& one = cases_[c];
    lowest = std::min(lowest, critical(one, velocity, injected_damping, nullptr));
    if (damping_force_ratio > 0.0 && injected_damping > 0.0 && lowest >= enough)
      for (const DamperPart& part : kDamperParts) {
        const Bound bound{injected_damping, damping_force_ratio, part.up_to, large_swing, lowest};
        lowest = std::min(
            lowest, critical(one, velocity, part.part * injected_damping, &bound) / large_swing);
      }
    if (lowest >= enough)
      continue;
    first_ = c;
    break;
  }
  return lowest;
}

}  // namespace voxtouch::coupling::design
