#pragma once
/// The reference's own triangulation of polygons.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/types/geometry.hpp"

namespace voxtouch::reference {

/// Cuts a polygon, convex or not, into triangles by ear clipping (Meisters 1975), in the coordinate
/// plane that it faces most. Numbers are positions in `corners`, which must be finite; a repeated
/// corner is skipped. A bridge may join a hole to the outline. Allocates; the time grows with the
/// third power of the corners. Throws std::runtime_error if the polygon crosses itself.
std::vector<std::array<std::uint32_t, 3>> clip_ears(std::span<const Vec3> corners);

}  // namespace voxtouch::reference
