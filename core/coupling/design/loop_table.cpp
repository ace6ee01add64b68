#include "core/coupling/design/loop_table.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/coupling/design/sampled_plant.hpp"

namespace voxtouch {
namespace {

using Complex = std::complex<double>;
constexpr std::size_t kPoints = 320;
/// Lowest frequency [rad/s]. Loops that become unstable below it have no stiffness worth a design.
constexpr double kLowest = 0.05;

std::vector<Complex> grid(double period_s) {
  std::vector<Complex> z(kPoints);
  const double top = std::numbers::pi / period_s, ratio = std::log(top / kLowest) / (kPoints - 1);
  for (std::size_t i = 0; i < kPoints; ++i)
    z[i] = std::polar(1.0, kLowest * std::exp(ratio * static_cast<double>(i)) * period_s);
  z.back() = -1.0;
  return z;
}

SampledPlant sampled(const LoopPlant& p) {
  return sample_plant(p.mass + p.hand_mass, p.damping + p.hand_damping, p.hand_stiffness, p.period_s, p.delay_s,
                      p.effort_lag_s);
}

/// Position for a unit of effort.
Complex plant_at(const SampledPlant& plant, Complex z) {
  const Eigen::Matrix3cd left = (z - 1.0) * Eigen::Matrix3cd::Identity() - plant.step_less_one.cast<Complex>();
  const Eigen::Vector3cd right = plant.newer.cast<Complex>() + plant.older.cast<Complex>() / z;
  return plant.effort_unit * (left.inverse() * right)[0] * std::pow(z, -plant.whole_delay);
}

/// A unit of damping on the filtered difference.
Complex damping_at(double velocity_filter_hz, Complex z, double period_s) {
  const double a = std::exp(-2.0 * std::numbers::pi * velocity_filter_hz * period_s);
  return (1.0 - a) / period_s * (1.0 - 1.0 / z) / (1.0 - a / z);
}

}  // namespace

std::complex<double> filter_at(double w0_rad_per_s, double damping_ratio, std::complex<double> z, double period_s) {
  const double g = 0.5 * w0_rad_per_s * period_s;
  const Complex s = (z - 1.0) / (g * (z + 1.0));  // s / w0
  if (std::abs(z + 1.0) < 1e-9) return 0.0;
  return 1.0 / (s * s + 2.0 * damping_ratio * s + 1.0);
}

LoopTable::LoopTable(const std::vector<DesignCase>& cases, const std::vector<double>& velocity_filters_hz) {
  for (const DesignCase& one : cases) {
    const double period = one.plant.period_s;
    auto timing = std::ranges::find(timings_, period, &Timing::period_s);
    if (timing == timings_.end()) timing = timings_.insert(timing, {period, grid(period)});
    Case entry{static_cast<std::size_t>(timing - timings_.begin()), {}, {}, {}};
    entry.damped.resize(velocity_filters_hz.size());
    const SampledPlant samples = sampled(one.plant);
    for (const Complex z : timing->z) {
      const Complex p = plant_at(samples, z);
      entry.plant.re.push_back(p.real()), entry.plant.im.push_back(p.imag());
      for (std::size_t v = 0; v < velocity_filters_hz.size(); ++v) {
        const Complex damped = p * damping_at(velocity_filters_hz[v], z, period);
        entry.damped[v].re.push_back(damped.real()), entry.damped[v].im.push_back(damped.imag());
      }
    }
    entry.loop = entry.plant;
    cases_.push_back(std::move(entry));
  }
}

void LoopTable::use(const std::function<Complex(Complex, double)>& law) {
  std::vector<std::vector<Complex>> laws;
  for (const Timing& timing : timings_) {
    laws.emplace_back();
    for (const Complex z : timing.z) laws.back().push_back(law(z, timing.period_s));
  }
  for (Case& one : cases_)
    for (std::size_t i = 0; i < kPoints; ++i) {
      const Complex loop = laws[one.timing][i] * Complex(one.plant.re[i], one.plant.im[i]);
      one.loop.re[i] = loop.real(), one.loop.im[i] = loop.imag();
    }
}

double LoopTable::critical(const Case& one, std::size_t velocity_filter, double injected_damping) const {
  const bool damped = injected_damping > 0.0;
  const Response& unit = damped ? one.damped[velocity_filter] : one.plant;
  const double b = damped ? injected_damping : 0.0;
  // L = loop / (1 + B unit); its real and imaginary part, times |1 + B unit|^2 > 0, which spares the divisions.
  const auto re = [&](std::size_t i) { return one.loop.re[i] * (1.0 + b * unit.re[i]) + one.loop.im[i] * b * unit.im[i]; };
  const auto im = [&](std::size_t i) { return one.loop.im[i] * (1.0 + b * unit.re[i]) - one.loop.re[i] * b * unit.im[i]; };
  const auto size = [&](std::size_t i) {
    const double x = 1.0 + b * unit.re[i], y = b * unit.im[i];
    return x * x + y * y;
  };
  double lowest = std::numeric_limits<double>::infinity(), before = im(0);
  // Past -180 degrees at the lowest frequency already: unstable from the beginning, or from a stiffness below all interest.
  if (before > 0.0 && re(0) < 0.0) return 0.0;
  for (std::size_t i = 1; i < kPoints; ++i) {
    const double now = im(i);
    if ((before < 0.0) != (now < 0.0)) {
      const double here = now / size(i), there = before / size(i - 1), share = there / (there - here);
      const double crossing = (1.0 - share) * re(i - 1) / size(i - 1) + share * re(i) / size(i);
      if (crossing < 0.0) lowest = std::min(lowest, -1.0 / crossing);
    }
    before = now;
  }
  const double nyquist = re(kPoints - 1) / size(kPoints - 1);
  return nyquist < 0.0 ? std::min(lowest, -1.0 / nyquist) : lowest;
}

double LoopTable::critical(std::size_t velocity_filter, double injected_damping, double enough) const {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Case& one : cases_) {
    lowest = std::min(lowest, critical(one, velocity_filter, injected_damping));
    if (lowest < enough) break;
  }
  return lowest;
}

}  // namespace voxtouch
