#pragma once
/// Triangles sorted into slabs of 8 voxels along i, the unit of parallel work. Slabs have no common
/// data, so results do not depend on their order.
#include <cstdint>
#include <span>
#include <vector>

#include "core/voxmap/grid_mesh.hpp"

namespace voxtouch::voxmap {

class Slabs {
 public:
  /// Slab s contains i in [base + 8 s, base + 8 s + 7].
  Slabs(const GridMesh& mesh, std::int32_t base, std::size_t count);
  std::size_t size() const noexcept { return start_.size() - 1; }
  std::int32_t first(std::size_t slab) const noexcept {
    return base_ + static_cast<std::int32_t>(8 * slab);
  }
  std::int32_t last(std::size_t slab) const noexcept { return first(slab) + 7; }
  /// Triangles that may meet a voxel of the slab, ascending.
  std::span<const std::uint32_t> triangles(std::size_t slab) const noexcept {
    return {triangles_.data() + start_[slab], triangles_.data() + start_[slab + 1]};
  }

 private:
  std::int32_t base_;
  std::vector<std::size_t> start_;
  std::vector<std::uint32_t> triangles_;
};

}  // namespace voxtouch::voxmap
