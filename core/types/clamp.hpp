#pragma once
/// Lengths of vectors and their limits: the one definition for coupling, guard and drivers. All
/// real-time safe.
#include <cmath>
#include <limits>

#include "core/types/geometry.hpp"

namespace voxtouch {

/// Length of `v`, also if the squares of its components would overflow or vanish; infinity above
/// the largest double, NaN or infinity if a component is.
inline double length_of(const Vec3& v) noexcept {
  const double largest = v.cwiseAbs().maxCoeff();
  return largest > 0.0 && std::isfinite(largest) ? largest * (v / largest).norm() : largest;
}

/// Cuts `v` to a length of at most `limit` (may be infinite) and keeps its direction; true if it
/// had to. Afterwards `v` is finite whatever it was: a vector that is not finite becomes zero, and
/// so does every vector under a limit that is negative or no number. The result's `length_of` is
/// never over the limit, not even by rounding.
inline bool clamp_length(Vec3& v, double limit) noexcept {
  if (!v.allFinite() || !(limit >= 0.0)) {
    v.setZero();
    return true;
  }
  if (!(length_of(v) > limit))
    return false;
  if (limit <
      std::numeric_limits<double>::min()) {  // among numbers that coarse a cut would round over it
    v.setZero();
    return true;
  }
  constexpr double kRounding = 1.0 - 16.0 * std::numeric_limits<double>::epsilon();
  const Vec3 direction =
      v / v.cwiseAbs().maxCoeff();  // components at most one: the norm below cannot overflow
  v = direction * (limit * kRounding / direction.norm());
  return true;
}

/// Which part of a wrench was over its limit.
struct WrenchCut {
  bool force = false, torque = false;
  /// Whether either was.
  bool any() const noexcept { return force || torque; }
};

/// Limits force [N] and torque [Nm] as `clamp_length`. A torque limit of zero means a device
/// without torque: the torque is dropped, which does not count as cut.
inline WrenchCut clamp_wrench(Wrench& wrench, double max_force_n, double max_torque_nm) noexcept {
  const bool force = clamp_length(wrench.force, max_force_n);
  const bool torque = clamp_length(wrench.torque, max_torque_nm);
  return {force, torque && max_torque_nm != 0.0};
}

}  // namespace voxtouch
