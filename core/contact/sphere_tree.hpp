#pragma once
/// Bounding spheres over runs of the pointshell: lets the query skip whole parts of the tool that
/// are far from the scene.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/pointshell/pointshell.hpp"

namespace voxtouch::contact {

/// Leaf n holds the points [8 n, 8 n + 8), a node above 16 neighbours of the level below. The
/// shell's Morton order makes runs compact; in any other order the tree is still right, only slow.
/// Walking it depth first keeps the shell's order.
///
/// Small leaves with a wide fan-out: sixteen spheres are one look of a kernel, and four leaves are
/// one block of points for it.
class SphereTree {
 public:
  static constexpr std::uint32_t kLeafPoints = 8;
  static constexpr std::uint32_t kFanOut = 16;
  static constexpr int kMaxLevels = 8;  ///< 8 * 16^7 points: 2^31

  /// The spheres of one level in single precision, frame T [m]: each encloses the points of its run
  /// for certain. Filled up to a multiple of kFanOut with zeros, which kernels look at and do not
  /// count.
  struct Level {
    std::vector<float> x, y, z, radius;
    std::size_t count = 0;  ///< without those
  };

  SphereTree() = default;
  /// Throws std::length_error for more than 2^31 points.
  explicit SphereTree(const pointshell::Pointshell& shell);

  /// Leaves first; the last has at most kFanOut spheres. Empty for a shell without points.
  const std::vector<Level>& levels() const noexcept { return levels_; }
  /// What a tree over that many points takes.
  static std::size_t bytes(std::size_t points) noexcept;

 private:
  std::vector<Level> levels_;
};

}  // namespace voxtouch::contact
