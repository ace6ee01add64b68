#include "core/voxmap/brick_distances.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace voxtouch::voxmap {
namespace {

/// Nodes are taken in blocks of 3^3, of which a brick has 3^3.
constexpr int kBlock = 3, kBlocks = DistanceField::kNodeEdge / kBlock;
constexpr std::size_t kOfBlock = kBlock * kBlock * kBlock;
static_assert(kBlock * kBlocks == DistanceField::kNodeEdge && kOfBlock <= DistanceTree::Points::kCount && kBlocks * kBlocks * kBlocks <= int{DistanceTree::Points::kCount});
/// From the middle of a brick, or a block, to its farthest node, and a little for rounding.
constexpr double kBrickReach = 4.0 * 1.7320509, kBlockReach = 1.7320509;
/// With more triangles near a brick than this each node asks the tree, which then is faster.
constexpr std::size_t kMostNear = 512;

using Points = DistanceTree::Points;

/// Calls f(n, x, y, z) for a block's nodes, or a brick's blocks: numbers below 3.
template <class F>
void for_27(F&& f) {
  std::size_t n = 0;
  for (int z = 0; z < 3; ++z)
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 3; ++x) f(n++, x, y, z);
}

void ask_the_tree(const DistanceTree& tree, const Vec3& first, const BrickLimits& limit, DistanceField::Brick& brick) {
  std::uint32_t place = DistanceTree::kNoPlace;
  for (int z = 0; z < DistanceField::kNodeEdge; ++z)
    for (int y = 0; y < DistanceField::kNodeEdge; ++y)
      for (int x = 0; x < DistanceField::kNodeEdge; ++x) {
        const double most = limit[node_of_brick(x, y, z)];
        const double distance = tree.nearest(first + Vec3(x, y, z), std::abs(most), place);
        brick[node_of_brick(x, y, z)] = static_cast<float>(most < 0.0 ? -distance : distance);
      }
}

}  // namespace

void signed_distances(const DistanceTree& tree, const Vec3& first, const BrickLimits& limit, DistanceField::Brick& brick) {
  double farthest = 0.0;
  for (const double most : limit) farthest = std::max(farthest, std::abs(most));
  // What is nearest to any node is within the middle's own distance and twice the way to that node.
  const Vec3 middle = first + Vec3::Constant(0.5 * (DistanceField::kNodeEdge - 1));
  const double nearest = tree.nearest(middle, farthest + kBrickReach);
  std::vector<std::uint32_t> near, nearer;
  if (!tree.within(middle, std::min(nearest + 2.0 * kBrickReach, farthest + kBrickReach), kMostNear, near)) return ask_the_tree(tree, first, limit, brick);

  Points middles;
  for_27([&](std::size_t b, int x, int y, int z) { middles.set(b, first + Vec3(kBlock * x + 1, kBlock * y + 1, kBlock * z + 1)); });
  std::vector<DistanceTree::Squares> of_blocks(near.size());
  DistanceTree::Squares least;
  least.fill(HUGE_VAL);
  for (std::size_t n = 0; n < near.size(); ++n) {
    tree.squares(near[n], middles, of_blocks[n]);
    for (std::size_t b = 0; b < least.size(); ++b) least[b] = std::min(least[b], of_blocks[n][b]);
  }
  for_27([&](std::size_t block, int bx, int by, int bz) {
    const double reach = std::min(std::sqrt(least[block]) + 2.0 * kBlockReach, farthest + kBlockReach) + 1e-6;
    nearer.clear();
    for (std::size_t n = 0; n < near.size(); ++n)
      if (of_blocks[n][block] <= reach * reach) nearer.push_back(near[n]);
    Points nodes;
    DistanceTree::Squares best, square;
    best.fill(HUGE_VAL);
    for_27([&](std::size_t n, int x, int y, int z) {
      nodes.set(n, first + Vec3(kBlock * bx + x, kBlock * by + y, kBlock * bz + z));
    });
    for (const std::uint32_t place : nearer) {
      tree.squares(place, nodes, square);
      for (std::size_t n = 0; n < best.size(); ++n) best[n] = std::min(best[n], square[n]);
    }
    for_27([&](std::size_t n, int x, int y, int z) {
      const std::size_t node = node_of_brick(kBlock * bx + x, kBlock * by + y, kBlock * bz + z);
      const double most = std::abs(limit[node]);
      const double distance = std::min(most, std::sqrt(std::min(most * most, best[n])));
      brick[node] = static_cast<float>(limit[node] < 0.0 ? -distance : distance);
    });
  });
}

}  // namespace voxtouch::voxmap
