#pragma once
/// The nodes of one brick of a distance field, all at once: few triangles are near a brick, so each is held against many nodes instead of
/// each node against the whole tree.
#include <array>

#include "core/voxmap/distance_field.hpp"
#include "core/voxmap/distance_tree.hpp"

namespace voxtouch::voxmap {

/// Where a brick has its node (x, y, z).
constexpr std::size_t node_of_brick(int x, int y, int z) noexcept {
  return static_cast<std::size_t>(x + DistanceField::kNodeEdge * (y + DistanceField::kNodeEdge * z));
}

/// How far distances are looked for at each node of a brick [voxels]; below 0 where the node is inside.
using BrickLimits = std::array<double, DistanceField::kNodeEdge * DistanceField::kNodeEdge * DistanceField::kNodeEdge>;

/// The distance from each node to the nearest triangle of the tree, its limit at most, with the limit's sign. `first`: the brick's first
/// node. Same bits as DistanceTree::nearest gives.
void signed_distances(const DistanceTree& tree, const Vec3& first, const BrickLimits& limit, DistanceField::Brick& brick);

}  // namespace voxtouch::voxmap
