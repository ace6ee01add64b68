#pragma once
/// How stiff a contact is compared with what is certified.
#include "core/coupling/coupling.hpp"
#include "core/coupling/ramp.hpp"

namespace voxtouch::coupling {

/// Largest eigenvalue of the symmetric part of a finite matrix; not below zero. The same matrix
/// gives bit-identical results: nothing is remembered from one to the next. Real-time safe.
double largest_eigenvalue(const Mat3& matrix) noexcept;
double largest_eigenvalue(const Mat6& matrix) noexcept;

/// The largest s <= 1 with s K <= diag(cap_t I, cap_r I) in the order of symmetric matrices:
///
///     s = min(1, 1 / lambda_max(N K N)),   N = diag(1/sqrt(cap_t) I, 1/sqrt(cap_r) I).
///
/// Caps come as their inverses, 0 for none. Where the matrix is zero but `bound` (spectral norm of
/// the translational part) is not, s = min(1, cap_t / bound). Finite inputs; always within [0, 1].
/// Real-time safe.
double cap_scale(const Mat6& stiffness, double bound, double per_cap_t, double per_cap_r) noexcept;

/// The scale for a contact that is stiffer than the caps: s above. The rendering's spring
/// (core/rendering/series_spring.hpp) leaves 1 of it; less is only needed where caps and spring
/// change, and for a contact that comes without one. Nothing of the contact is stored. Real-time
/// safe.
class StiffnessScale {
 public:
  /// The caps of `spec`, as `validate` accepts it; infinity: none.
  explicit StiffnessScale(const CouplingSpec& spec) noexcept;
  /// New caps. A contact that pushes meanwhile does not jump: from what it is scaled to now it goes
  /// to what the new caps ask for in a straight line over kDefaultRampS.
  void redesign(const CouplingSpec& spec) noexcept;
  /// s of this sample; `input` as `usable` accepts it.
  double step(const CouplingInput& input, double dt_s) noexcept;

 private:
  double per_cap_t_, per_cap_r_, scale_ = 1.0;
  bool redesigned_ = false;
  Ramp over_{1.0};  ///< the scale, in units of what the new caps ask for, on its way to one
};

}  // namespace voxtouch::coupling
