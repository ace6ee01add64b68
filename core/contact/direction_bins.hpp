#pragma once
/// The sphere of directions in bins, fixed in W: the vertices and the edge middles of an icosahedron, 31 to 36 degrees apart.
#include <cstddef>

#include "core/types/geometry.hpp"

namespace voxtouch::contact {

inline constexpr std::size_t kDirectionBins = 42;

/// The bin whose direction is nearest to `normal` (unit, in W). Real-time safe.
std::size_t nearest_direction_bin(const Vec3& normal) noexcept;

}  // namespace voxtouch::contact
