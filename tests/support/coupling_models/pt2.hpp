#pragma once
/// The ring's second-order low-pass for one number, without the other parts of ShapingFilter.
#include "core/coupling/pt2.hpp"

namespace voxtouch::coupling_models {

/// The filter for one number. Real-time safe.
class Pt2 {
 public:
  Pt2() = default;
  Pt2(double w0_rad_per_s, double damping_ratio, double gain) noexcept {
    design(w0_rad_per_s, damping_ratio, gain);
  }

  /// New parameters, at any time, without touching the state. Any finite gain, also negative; any
  /// finite w0 > 0, d > 0, also beyond the Nyquist frequency. False, and nothing changed,
  /// otherwise.
  bool design(double w0_rad_per_s, double damping_ratio, double gain) noexcept {
    const bool usable = w0_rad_per_s > 0.0 && damping_ratio > 0.0 && std::isfinite(w0_rad_per_s) &&
                        std::isfinite(damping_ratio) && std::isfinite(gain);
    if (usable)
      w0_ = w0_rad_per_s, d_ = damping_ratio, gain_ = gain, period_ = 0.0;
    return usable;
  }
  /// One sample of a finite input over a finite period > 0 [s]: callers that cannot promise that go
  /// through ShapingFilter.
  double step(double u, double period_s) noexcept {
    if (period_s != period_)
      k_ = coupling::Pt2Coefficients::of(w0_, d_, period_s), period_ = period_s;
    return state_.advance(k_, gain_, u);
  }
  /// At rest at `y0`: the next step with input y0 / K gives y0 again.
  void reset(double y0 = 0.0) noexcept { state_.reset(y0, gain_); }
  const coupling::Pt2State& state() const noexcept { return state_; }

 private:
  double w0_ = 1.0, d_ = 1.0, gain_ = 1.0, period_ = 0.0;
  coupling::Pt2Coefficients k_;
  coupling::Pt2State state_;
};

}  // namespace voxtouch::coupling_models
