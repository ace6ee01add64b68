#pragma once
/// The reference's own way from a polygon to triangles.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/types/geometry.hpp"

namespace voxtouch::reference {

/// Cuts a polygon, convex or not, into triangles by taking off one ear after the other (Meisters
/// 1975), in the coordinate plane that it faces most. Numbers are positions in `corners`, which are
/// finite; a corner at the place of the one before it is skipped. A bridge may join a hole to the
/// outline. Allocates; time goes with the third power of the corners. Throws std::runtime_error
/// where the polygon crosses itself.
std::vector<std::array<std::uint32_t, 3>> clip_ears(std::span<const Vec3> corners);

}  // namespace voxtouch::reference
