#include "core/coupling/shaping_filter.hpp"

#include <algorithm>

namespace voxtouch::coupling {
namespace {

/// Index order: force x y z, torque x y z.
template <class W>
auto& component(W& w, std::size_t i) noexcept {
  return i < 3 ? w.force[static_cast<Eigen::Index>(i)] : w.torque[static_cast<Eigen::Index>(i - 3)];
}

}  // namespace

ShapingFilter::ShapingFilter(const CouplingSpec& spec, double nominal_period_s) noexcept
    : w0_(cutoff_rad_per_s(spec)),
      d_(spec.damping_ratio),
      gain_(spec.gain),
      gain_requested_(spec.gain),
      gain_step_(kGainSlewPerS * nominal_period_s) {}

void ShapingFilter::redesign(const CouplingSpec& spec) noexcept {
  w0_ = cutoff_rad_per_s(spec), d_ = spec.damping_ratio, gain_requested_ = spec.gain;
}

double ShapingFilter::advance_gain() noexcept {
  return gain_ = std::clamp(gain_requested_, gain_ - gain_step_, gain_ + gain_step_);
}

void ShapingFilter::start_at(const Wrench& start) noexcept {
  start_ = start;
  for (std::size_t i = 0; i < states_.size(); ++i)
    states_[i].reset(component(start_, i), gain_);
}

Wrench ShapingFilter::step(const LawInput& in) noexcept {
  const Pt2Coefficients k = Pt2Coefficients::of(w0_, d_, in.dt_s);
  const double back = gain_ > 0.0
                          ? (1.0 - in.weight) / gain_
                          : 0.0;  // input that would maintain the start force, times its fraction
  Wrench given;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const double u = in.weight < 1.0
                         ? in.weight * component(in.contact, i) + back * component(start_, i)
                         : component(in.contact, i);
    component(given, i) = states_[i].advance(k, gain_, u);
  }
  return given;
}

}  // namespace voxtouch::coupling
