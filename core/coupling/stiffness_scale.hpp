#pragma once
/// Scales a contact that is stiffer than the certified stiffness.
#include "core/coupling/coupling.hpp"
#include "core/coupling/ramp.hpp"

namespace voxtouch::coupling {

/// Largest eigenvalue of the symmetric part of a finite matrix, at least 0. Equal matrices give
/// bit-identical results, because no state is kept. Real-time safe.
double largest_eigenvalue(const Mat3& matrix) noexcept;
double largest_eigenvalue(const Mat6& matrix) noexcept;

/// The largest s <= 1 with s K <= diag(cap_t I, cap_r I) in the order of symmetric matrices:
///
///     s = min(1, 1 / lambda_max(N K N)),   N = diag(1/sqrt(cap_t) I, 1/sqrt(cap_r) I).
///
/// Caps are given as their inverses, 0 for no cap. If the matrix is zero but `bound` (spectral norm
/// of the translational part) is not, s = min(1, cap_t / bound). Requires finite inputs; the result
/// is in [0, 1]. Real-time safe.
double cap_scale(const Mat6& stiffness, double bound, double per_cap_t, double per_cap_r) noexcept;

/// The scale s above for a contact stiffer than the caps. The spring of the rendering
/// (core/rendering/series_spring.hpp) normally makes it 1. A smaller scale is needed only while
/// caps and spring change, and for a contact without a spring. Stores no contact. Real-time safe.
class StiffnessScale {
 public:
  /// Takes the caps of a validated `spec`; infinity: no cap.
  explicit StiffnessScale(const CouplingSpec& spec) noexcept;
  /// Sets new caps. During contact the scale ramps linearly from its present value to the new one
  /// over kDefaultRampS.
  void redesign(const CouplingSpec& spec) noexcept;
  /// s of this sample, `dt_s` [s] after the last, for a `usable` input.
  double step(const CouplingInput& input, double dt_s) noexcept;

 private:
  double per_cap_t_, per_cap_r_, scale_ = 1.0;
  bool redesigned_ = false;
  Ramp over_{1.0};  ///< the scale relative to that of the new caps, ramping to 1
};

}  // namespace voxtouch::coupling
