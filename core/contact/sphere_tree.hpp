#pragma once
/// Bounding spheres over runs of the pointshell: lets the query skip whole parts of the tool that are far from the scene.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/pointshell/pointshell.hpp"

namespace voxtouch {

/// Leaf n holds the points [32 n, 32 n + 32), a node above 16 neighbours of the level below. The shell's Morton order makes
/// runs compact; in any other order the tree is still right, only slow. Walking it depth first keeps the shell's order.
class SphereTree {
 public:
  static constexpr std::uint32_t kLeafPoints = 32;
  static constexpr std::uint32_t kFanOut = 16;
  static constexpr int kMaxLevels = 8;  ///< 32 * 16^7 points: beyond uint32

  /// Encloses the points of its run; frame T [m].
  struct Sphere {
    double x = 0.0, y = 0.0, z = 0.0, radius = 0.0;
  };

  SphereTree() = default;
  explicit SphereTree(const Pointshell& shell);

  /// Calls `leaf(begin, end)` with point indices, ascending, for each leaf none of whose spheres `culled(sphere)` drops.
  /// No recursion, no allocation: one cursor a level. Real-time safe if the two callables are.
  template <class Culled, class Leaf>
  void visit(Culled&& culled, Leaf&& leaf) const;

  /// All levels, leaves first.
  const std::vector<std::vector<Sphere>>& levels() const noexcept { return levels_; }
  std::uint32_t points() const noexcept { return points_; }

 private:
  std::vector<std::vector<Sphere>> levels_;
  std::uint32_t points_ = 0;
};

template <class Culled, class Leaf>
void SphereTree::visit(Culled&& culled, Leaf&& leaf) const {
  if (points_ == 0) return;
  std::array<std::uint32_t, kMaxLevels> next{}, end{};
  const std::size_t top = levels_.size() - 1;
  end[top] = 1;
  for (std::size_t level = top;;) {
    if (next[level] == end[level]) {
      if (level == top) return;
      ++level;
      continue;
    }
    const std::uint32_t node = next[level]++;
    if (culled(levels_[level][node])) continue;
    if (level == 0) {
      leaf(node * kLeafPoints, std::min(points_, (node + 1) * kLeafPoints));
      continue;
    }
    --level;
    next[level] = node * kFanOut;
    end[level] = std::min(static_cast<std::uint32_t>(levels_[level].size()), next[level] + kFanOut);
  }
}

}  // namespace voxtouch
