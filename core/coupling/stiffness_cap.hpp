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

/// What the cap leaves of a contact.
struct CapScales {
  double wrench = 1.0;     ///< share of the wrench, from `stiffness` to 1
  double stiffness = 1.0;  ///< share of its stiffness: s
};

/// The cap in time. Real-time safe.
///
/// s falls at once, so that an impact never shows more than the cap. It rises to its value over `ramp_behind_filter_s`: the
/// displayed share of the stiffness, s over what the cap allows, grows no faster than from 0 to 1 in that time.
///
/// Of the force F not s F is given, which would be the cap times the points' mean depth, half of the cap's promise under a ball:
/// a point that comes in with depth zero would take its share of what the others give. It is the increment that is capped. Let d be the
/// depth of the deepest point and c = s n'Kn the stiffness shown along F = |F| n. The force given, g n, begins at zero with the contact and
/// grows by
///
///     c (d - d before),   at most by what |F| has grown,   within   s |F| <= g <= max(s |F|, min(|F|, c d)).
///
/// While the tool goes in, dg/dd <= c <= cap, as before, and g reaches the cap times the depth but for what the contact itself lacks
/// until it is as stiff as the cap: c (d - d0/2) under a ball, d0 the depth where it is. g never falls while d grows. On the way out it falls as it rose,
/// c (d before - d), so a cycle gives no energy; where s lags it is less than on the way in. No pose has more than the wrench itself,
/// nor, but for the time in which s rises once, more than c d: what a tool gains by sliding from a stiff place to a softer one is bounded by that.
/// Where no depth is told, as with effects alone, s F is given. A wrench keeps its direction: force and torque have the same share.
class StiffnessCap {
 public:
  /// The caps of `spec`, as `validate` accepts it; infinity: none.
  explicit StiffnessCap(const CouplingSpec& spec) noexcept;
  /// New caps. A contact that pushes meanwhile does not jump: from what it shows now the displayed stiffness goes to what the
  /// new caps let it show in a straight line, over kDefaultRampS or `ramp_behind_filter_s`, whichever is longer, also from or to
  /// no cap at all. Slower than the rise above, because there nothing has to be let go soon, and a stiffness that rises by dk
  /// faster than the tool follows gives the hand up to dk p^2 / 2.
  void redesign(const CouplingSpec& spec) noexcept;
  /// The shares for this sample; `input` as `usable` accepts it.
  CapScales step(const CouplingInput& input, double dt_s) noexcept;
  /// Nothing is known of before: the next contact is scaled at once as it comes, by s, also where it begins deep inside.
  void reset() noexcept { scale_ = 1.0, over_ = Ramp(1.0), given_n_ = 0.0, size_n_ = 0.0, depth_m_ = kUnknown; }

 private:
  static constexpr double kUnknown = 1e300;  ///< no contact is deeper than that, so the first one gets nothing by it
  double secant(const CouplingInput& input, double allowed, double dt_s) noexcept;

  double rise_s_, per_cap_t_, per_cap_r_, scale_ = 1.0;
  bool redesigned_ = false;
  Ramp over_{1.0};  ///< what is shown, in units of what the new caps allow, on its way to one
  double given_n_ = 0.0, size_n_ = 0.0, depth_m_ = kUnknown;  ///< of the last sample: what was given of the force, the force, the depth
};

}  // namespace voxtouch::coupling
