#pragma once
/// The rotation between two orientations as a vector, for contact, coupling and drivers.
#include <cmath>

#include "core/types/geometry.hpp"

namespace voxtouch {

/// The rotation from `from` to `to`, both of unit norm, along the shorter arc: axis times angle
/// [rad], in their common frame. Zero if they are equal. Real-time safe.
inline Vec3 rotation_vector(const Quat& from, const Quat& to) noexcept {
  Quat rotation = to * from.conjugate();
  if (rotation.w() < 0.0)
    rotation.coeffs() = -rotation.coeffs();
  const double sine = rotation.vec().norm();
  if (!(sine > 0.0))
    return Vec3::Zero();
  return (2.0 * std::atan2(sine, rotation.w()) / sine) * rotation.vec();
}

}  // namespace voxtouch
