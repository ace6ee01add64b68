#pragma once
/// The coupling of the paper: each component of the contact's wrench passes the same second-order
/// low-pass (pt2.hpp).
#include <array>

#include "core/coupling/coupling_spec.hpp"
#include "core/coupling/law_input.hpp"
#include "core/coupling/pt2.hpp"

namespace voxtouch::coupling {

/// Fastest change of the gain at run time [1/s], counted in nominal periods.
inline constexpr double kGainSlewPerS = 1.0;

/// Force in, force out. K is dimensionless, so a constant contact is returned times K exactly. The
/// filter works in W: the axes of its six components do not rotate with the tool. Real-time safe.
class ShapingFilter {
 public:
  /// Requires a validated `spec`. `nominal_period_s`: T [s], > 0.
  ShapingFilter(const CouplingSpec& spec, double nominal_period_s) noexcept;

  /// One sample: K H_f of the contact, faded in from the start force [N, Nm], W axes. Source: the
  /// paper, section 3.
  Wrench step(const LawInput& input) noexcept;
  /// Restarts from the force `start` without a jump.
  void start_at(const Wrench& start) noexcept;
  /// Sets validated parameters at run time. Cut-off and damping change immediately (the state
  /// cannot grow by it), the gain no faster than kGainSlewPerS.
  void redesign(const CouplingSpec& spec) noexcept;
  double gain() const noexcept { return gain_; }  ///< K of this sample, also during a ramp
  /// Advances the gain by one sample. The input of `step` must be clamped to limit / gain, so that
  /// the state does not wind up on a peak that the device cannot give.
  double advance_gain() noexcept;

 private:
  double w0_, d_, gain_, gain_requested_, gain_step_;
  std::array<Pt2State, 6> states_{};  // force x y z, torque x y z
  Wrench start_;
};

}  // namespace voxtouch::coupling
