#pragma once
/// The paper's coupling: each component of the contact's wrench through the same second-order
/// low-pass (pt2.hpp).
#include <array>

#include "core/coupling/coupling_spec.hpp"
#include "core/coupling/law_input.hpp"
#include "core/coupling/pt2.hpp"

namespace voxtouch::coupling {

/// Fastest change of the gain at run time [1/s], counted in nominal periods.
inline constexpr double kGainSlewPerS = 1.0;

/// Force in, force out; K dimensionless, so that a held contact is given back times K exactly.
/// Works in W: the axes of the six components do not turn with the tool. Real-time safe.
class ShapingFilter {
 public:
  /// `spec` as `validate` accepts it.
  ShapingFilter(const CouplingSpec& spec, double nominal_period_s) noexcept;

  /// One sample: K H_f of the contact, faded in from the force given at the start [N, Nm], W axes.
  /// Source: the paper, section 3.
  Wrench step(const LawInput& input) noexcept;
  /// Starts again, giving `start` without a jump.
  void start_at(const Wrench& start) noexcept;
  /// New parameters while running, as `validate` accepts them: cut-off and damping at once (the
  /// state cannot grow by it), the gain no faster than kGainSlewPerS.
  void redesign(const CouplingSpec& spec) noexcept;
  double gain() const noexcept {
    return gain_;
  }  ///< as it is now, on its way to the one that was set
  /// Moves the gain on by a sample. The input of `step` is to be cut at limit / gain, so that the
  /// state never winds up on a peak that the device cannot give.
  double advance_gain() noexcept;

 private:
  double w0_, d_, gain_, gain_requested_, gain_step_;
  std::array<Pt2State, 6> states_{};  // force x y z, torque x y z
  Wrench start_;
};

}  // namespace voxtouch::coupling
