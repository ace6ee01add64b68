#pragma once
/// The nodes of one brick of a distance field, all at once: few triangles are near a brick, so each
/// is compared with many nodes instead of each node against the whole tree.
#include <array>

#include "core/voxmap/distance_field.hpp"
#include "core/voxmap/distance_tree.hpp"

namespace voxtouch::voxmap {

/// Where a brick has its node (x, y, z).
constexpr std::size_t node_of_brick(int x, int y, int z) noexcept {
  return static_cast<std::size_t>(x +
                                  DistanceField::kNodeEdge * (y + DistanceField::kNodeEdge * z));
}

/// A brick's own nodes are those below 8 on each axis: the others are the next bricks' own. They
/// are worked out in blocks of 4 x 4 x 2.
inline constexpr std::size_t kOwnNodes = 512, kOfBlock = DistanceTree::Points::kCount;
/// Which of its own nodes (x, y, z) is.
constexpr std::size_t own_node(int x, int y, int z) noexcept {
  const int block = (x >> 2) + 2 * (y >> 2) + 4 * (z >> 1),
            of_block = (x & 3) + 4 * (y & 3) + 16 * (z & 1);
  return kOfBlock * static_cast<std::size_t>(block) + static_cast<std::size_t>(of_block);
}
static_assert(own_node(7, 7, 7) == kOwnNodes - 1);

/// How far distances are looked for at each own node [voxels]; below 0 where the node is inside.
using BrickLimits = std::array<double, kOwnNodes>;

/// The distance from each own node to the nearest triangle of the tree, its limit at most, with the
/// limit's sign. `first`: the brick's first node, whole numbers. `place`: of a triangle that is
/// near, which makes it faster and changes nothing, or DistanceTree::kNoPlace. Bit-identical to
/// DistanceTree::nearest. The other nodes stay as they are.
void signed_distances(const DistanceTree& tree, const Vec3& first, const BrickLimits& limit,
                      std::uint32_t place, DistanceField::Brick& brick);

}  // namespace voxtouch::voxmap
