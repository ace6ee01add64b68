#pragma once
/// Lengths and limits of commands, used by the guard and, once more, by every driver directly before the
/// wire.
#include <algorithm>
#include <cmath>
#include <limits>

#include "devices/driver.hpp"

namespace voxtouch {

/// Length of `v`, also where the squares of its components would overflow or vanish; Inf if it is over the
/// largest double.
inline double length_of(const Vec3& v) noexcept {
  const double largest = v.cwiseAbs().maxCoeff();
  return largest > 0.0 && std::isfinite(largest) ? largest * (v / largest).norm() : largest;
}

/// Cuts `v` to a length of at most `limit` (>= 0, may be infinite) and keeps its direction; true if it had
/// to. A vector that is not finite becomes zero. The result's `length_of` is never over the limit, not even
/// by rounding.
inline bool clamp_length(Vec3& v, double limit) noexcept {
  if (!v.allFinite()) {
    v.setZero();
    return true;
  }
  if (!(length_of(v) > limit)) return false;
  constexpr double kRounding = 1.0 - 16.0 * std::numeric_limits<double>::epsilon();
  const Vec3 direction = v / v.cwiseAbs().maxCoeff();  // components at most one: the norm below cannot overflow
  v = direction * (limit * kRounding / direction.norm());
  return true;
}

/// The last check before the wire: may this command go to a device with this description?
inline DeviceResult<void> check_command(const Wrench& command, const DeviceDescription& device) noexcept {
  if (!command.finite()) return std::unexpected(DeviceError::kNotFinite);
  if (length_of(command.force) > device.max_force_n) return std::unexpected(DeviceError::kLimit);
  if (length_of(command.torque) > device.max_torque_nm) return std::unexpected(DeviceError::kLimit);
  return {};
}

}  // namespace voxtouch
