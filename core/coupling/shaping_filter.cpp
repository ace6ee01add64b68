#include "core/coupling/shaping_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace voxtouch {
namespace {

double& component(Wrench& w, std::size_t i) noexcept {
  return i < 3 ? w.force[static_cast<Eigen::Index>(i)] : w.torque[static_cast<Eigen::Index>(i - 3)];
}

}  // namespace

ShapingFilter::ShapingFilter(const CouplingSpec& spec, const CouplingLimits& limits, double sample_time_s,
                             double ramp_s) noexcept
    : policy_(limits, sample_time_s, ramp_s),
      w0_(cutoff_rad_per_s(spec)),
      d_(spec.damping_ratio),
      gain_(spec.gain),
      gain_wanted_(spec.gain) {}

bool ShapingFilter::set(double cutoff_hz, double damping_ratio, double gain) noexcept {
  const double w0 = 2.0 * std::numbers::pi * cutoff_hz;
  if (!(w0 > 0.0 && std::isfinite(w0) && damping_ratio > 0.0 && std::isfinite(damping_ratio) && gain >= 0.0 &&
        std::isfinite(gain)))
    return false;
  w0_ = w0, d_ = damping_ratio, gain_wanted_ = gain;
  return true;
}

void ShapingFilter::reset(const Wrench& held) noexcept {
  rest_at(policy_.restart(held));
}

void ShapingFilter::rest_at(const Wrench& held) noexcept {
  held_ = given_ = held;
  for (std::size_t i = 0; i < states_.size(); ++i) states_[i].reset(component(held_, i), gain_);
}

Wrench ShapingFilter::step(const CouplingInput& input, double dt_s) noexcept {
  const double slew = kGainSlewPerS * policy_.nominal_period_s();
  gain_ = std::clamp(gain_wanted_, gain_ - slew, gain_ + slew);
  PolicedInput in = policy_.take(input, dt_s, gain_);
  if (in.gap) rest_at(given_);
  const Pt2Coefficients k = Pt2Coefficients::of(w0_, d_, in.dt_s);
  const double back = gain_ > 0.0 ? (1.0 - in.weight) / gain_ : 0.0;  // input that would keep the held force, times its share
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const double u = in.weight < 1.0 ? in.weight * component(in.contact, i) + back * component(held_, i)
                                     : component(in.contact, i);
    component(given_, i) = states_[i].advance(k, gain_, u);
  }
  return given_;
}

}  // namespace voxtouch
