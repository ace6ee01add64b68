#pragma once
/// The nodes of one brick of a distance field, all at once. Few triangles are near a brick, so each
/// is compared with many nodes instead of each node with the whole tree.
#include <array>

#include "core/voxmap/distance_field.hpp"
#include "core/voxmap/distance_tree.hpp"

namespace voxtouch::voxmap {

/// Index of the node (x, y, z) in a brick.
constexpr std::size_t node_of_brick(int x, int y, int z) noexcept {
  return static_cast<std::size_t>(x +
                                  DistanceField::kNodeEdge * (y + DistanceField::kNodeEdge * z));
}

/// The nodes below 8 on each axis belong to the brick; the others to the next bricks. They are
/// computed in blocks of 4 x 4 x 2.
inline constexpr std::size_t kOwnNodes = 512, kOfBlock = DistanceTree::Points::kCount;
/// Index of the own node (x, y, z).
constexpr std::size_t own_node(int x, int y, int z) noexcept {
  const int block = (x >> 2) + 2 * (y >> 2) + 4 * (z >> 1),
            of_block = (x & 3) + 4 * (y & 3) + 16 * (z & 1);
  return kOfBlock * static_cast<std::size_t>(block) + static_cast<std::size_t>(of_block);
}
static_assert(own_node(7, 7, 7) == kOwnNodes - 1);

/// Search radius at each own node [voxels]; negative if the node is inside.
using BrickLimits = std::array<double, kOwnNodes>;

/// Distance from each own node to the nearest triangle of the tree, limited to the search radius,
/// with the sign of the limit. `first`: first node of the brick, integers. `place`: of a nearby
/// triangle, which speeds up the search without changing the result, or DistanceTree::kNoPlace.
/// Bit-identical to DistanceTree::nearest. Other nodes are unchanged.
void signed_distances(const DistanceTree& tree, const Vec3& first, const BrickLimits& limit,
                      std::uint32_t place, DistanceField::Brick& brick);

}  // namespace voxtouch::voxmap
