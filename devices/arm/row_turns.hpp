#pragma once
/// The two rotations of a Denavit-Hartenberg row.
#include <cmath>
#include <numbers>

#include "core/types/geometry.hpp"

namespace voxtouch::arm {

/// Rotation about x by multiples of 90 degrees (-1, 0, 1), without the rounding of a cosine.
inline Quat quarter_turns_about_x(int turns) noexcept {
  const double half = std::numbers::sqrt2 / 2.0;
  return turns == 0 ? Quat::Identity() : Quat(half, turns * half, 0.0, 0.0);
}

/// About z by `angle` [rad].
inline Quat rotate_about_z(double angle) noexcept {
  return {std::cos(angle / 2.0), 0.0, 0.0, std::sin(angle / 2.0)};
}

}  // namespace voxtouch::arm
