#pragma once
/// The voxels that are not surface, grouped by common faces; empty bricks are processed as a whole.
#include <array>
#include <cstdint>
#include <vector>

#include "core/types/parallel.hpp"
#include "core/voxmap/brick_bits.hpp"
#include "core/voxmap/grid.hpp"

namespace voxtouch::voxmap {

/// Surface voxels as bits, in the cells of a voxmap. The border cells contain none.
struct SurfaceBits {
  VoxelIndex base;  ///< first voxel, a multiple of 8
  std::array<std::int64_t, 3> cells{};
  /// Of each cell, (x * cells[1] + y) * cells[2] + z; -1: no surface voxel.
  std::vector<std::int32_t> brick_of;
  std::vector<BrickMask> bricks;

  VoxelIndex first_voxel(std::size_t cell) const noexcept {
    const auto c = static_cast<std::int64_t>(cell);
    return {static_cast<std::int32_t>(base.i + 8 * (c / (cells[1] * cells[2]))),
            static_cast<std::int32_t>(base.j + 8 * (c / cells[2] % cells[1])),
            static_cast<std::int32_t>(base.k + 8 * (c % cells[2]))};
  }
};

/// A piece of a group within a brick that also contains surface.
struct GroupPiece {
  std::size_t cell;
  BrickMask voxels;
};

struct VoxelGroups {
  std::vector<GroupPiece> pieces;
  std::vector<std::uint32_t> first_piece;  ///< of each brick, one more at the end
  /// Of each cell (unused for cells with surface), then of each piece; 0 is the outside.
  std::vector<std::uint32_t> group;
  std::vector<VoxelIndex> representative;  ///< one voxel of each group
};

/// Groups of the voxels outside `surface`, by common faces; equal for any `parallel_for`.
/// Allocates.
VoxelGroups group_voxels(const SurfaceBits& surface, const ParallelFor& parallel_for);

}  // namespace voxtouch::voxmap
