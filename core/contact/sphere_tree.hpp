#pragma once
/// Bounding spheres over runs of the pointshell. With them the query skips parts of the tool that
/// are far from the scene.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/pointshell/pointshell.hpp"

namespace voxtouch::contact {

/// Leaf n contains the points [8 n, 8 n + 8); a node covers 16 neighbours of the level below. The
/// Morton order of the shell makes runs compact; in any other order the tree is valid but slow.
/// Depth-first traversal keeps the order of the shell.
/// Leaves are small and the fan-out is wide: one kernel call tests sixteen spheres, and four leaves
/// form one block of points.
class SphereTree {
 public:
  static constexpr std::uint32_t kLeafPoints = 8;
  static constexpr std::uint32_t kFanOut = 16;
  static constexpr int kMaxLevels = 8;  ///< 8 * 16^7 points: 2^31

  /// The spheres of one level in single precision, frame T [m]: each certainly encloses the points
  /// of its run. Padded to a multiple of kFanOut with zeros, which kernels read and ignore.
  struct Level {
    std::vector<float> x, y, z, radius;
    std::size_t count = 0;  ///< without the padding
  };

  SphereTree() = default;
  /// Throws std::length_error for more than 2^31 points.
  explicit SphereTree(const pointshell::Pointshell& shell);

  /// Leaves first; the last level has at most kFanOut spheres. Empty for a shell without points.
  const std::vector<Level>& levels() const noexcept { return levels_; }
  /// Memory of a tree over that many points.
  static std::size_t bytes(std::size_t points) noexcept;

 private:
  std::vector<Level> levels_;
};

}  // namespace voxtouch::contact
