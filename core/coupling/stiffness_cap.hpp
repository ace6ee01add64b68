#pragma once
/// Keeps the stiffness that the coupling is given below a cap, however many points push.
#include "core/coupling/coupling.hpp"
#include "core/coupling/ramp.hpp"

namespace voxtouch::coupling {

/// Largest eigenvalue of the symmetric part of a finite matrix; not below zero. The same matrix gives the same bits: nothing
/// is remembered from one to the next. Real-time safe.
double largest_eigenvalue(const Mat3& matrix) noexcept;
double largest_eigenvalue(const Mat6& matrix) noexcept;

/// The largest s <= 1 with s K <= diag(cap_t I, cap_r I) in the order of symmetric matrices:
///
///     s = min(1, 1 / lambda_max(N K N)),   N = diag(1/sqrt(cap_t) I, 1/sqrt(cap_r) I).
///
/// Caps come as their inverses, 0 for none. Where the matrix is zero but `bound` (spectral norm of the translational part) is
/// not, s = min(1, cap_t / bound). Finite inputs; always within [0, 1]. Real-time safe.
double cap_scale(const Mat6& stiffness, double bound, double per_cap_t, double per_cap_r) noexcept;

/// The cap in time. Real-time safe.
///
/// s falls at once, so that an impact never shows more than the cap. It rises to its value over `ramp_behind_filter_s`: the
/// displayed share of the stiffness, s over what the cap allows, grows no faster than from 0 to 1 in that time.
///
/// What that does to the force: while the contact grows, dF/dx <= cap. A point that comes in comes with depth zero, so the raw
/// force F has no step, but s has: N alike points become N + 1 and the scaled force falls by its (N + 1)th part. With each of
/// them at its own depth, N points give cap times their mean depth. On the way out s lags, so the force is lower than on the
/// way in: a cycle costs the hand energy and gives it none.
class StiffnessCap {
 public:
  /// The caps of `spec`, as `validate` accepts it; infinity: none.
  explicit StiffnessCap(const CouplingSpec& spec) noexcept;
  /// New caps. A contact that pushes meanwhile does not jump: from what it shows now the displayed stiffness goes to what the
  /// new caps let it show in a straight line, over kDefaultRampS or `ramp_behind_filter_s`, whichever is longer, also from or to
  /// no cap at all. Slower than the rise above, because there nothing has to be let go soon, and a stiffness that rises by dk
  /// faster than the tool follows gives the hand up to dk p^2 / 2.
  void redesign(const CouplingSpec& spec) noexcept;
  /// s for this sample; `input` as `usable` accepts it.
  double step(const CouplingInput& input, double dt_s) noexcept;
  /// Nothing pushes: the next contact is scaled at once as it comes.
  void reset() noexcept { scale_ = 1.0, over_ = Ramp(1.0); }

 private:
  double rise_s_, per_cap_t_, per_cap_r_, scale_ = 1.0;
  bool redesigned_ = false;
  Ramp over_{1.0};  ///< what is shown, in units of what the new caps allow, on its way to one
};

}  // namespace voxtouch::coupling
