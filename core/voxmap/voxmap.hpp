#pragma once
/// The static scene as a voxmap: surface, interior and free voxels (paper, section 1), in bricks
/// behind a two-level table.
///
/// Bricks: 8x8x8 voxels with 2 bits each, one for each 8-voxel cell with surface, and shared bricks
/// for "all free" and "all interior". Bricks are in Morton order of their cells. One border cell of
/// free bricks surrounds the object.
///
/// Table: a block is 4x4x4 cells. Its page (a cache line) has one byte for each cell, which selects
/// one of the block's own bricks or a shared one. Blocks without surface share two pages, so only 8
/// bytes per block grow with the volume. Up to kFewTableBytes, a table names the brick of each cell
/// directly. Strides are exact: powers of two would need up to four times the memory.
///
/// Free distances: one byte for each cell of 4x4x4 voxels or more is a lower bound of the distance
/// to the nearest surface or interior voxel (free_distance.hpp), for the culling tree.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/types/huge_pages.hpp"
#include "core/voxmap/brick_bits.hpp"
#include "core/voxmap/free_distance.hpp"
#include "core/voxmap/grid.hpp"

namespace voxtouch::voxmap {

enum class VoxelKind : std::uint8_t { kFree = 0, kSurface = 1, kInterior = 2 };

class Voxmap {
 public:
  static constexpr int kBrickEdge = 8;  ///< voxels
  /// 512 voxels x 2 bits; voxel (x,y,z) at bit 2*(x + 8*(y + 8*z))
  using Brick = std::array<std::uint64_t, 16>;

  Voxmap() = default;
  /// A map for voxels `first`..`last` (inclusive), all free. Throws std::length_error for more than
  /// `kMaxTableCells` cells or indices beyond +-2^30; callers estimate first (grid_mesh.hpp).
  Voxmap(const Grid& grid, const VoxelIndex& first, const VoxelIndex& last);

  const Grid& grid() const noexcept { return grid_; }

  /// Kind of a voxel; all voxels outside the table are free. Real-time safe.
  VoxelKind at(const VoxelIndex& v) const noexcept {
    const auto [x, y, z] = local(v);
    if ((x | y | z) < 0 || (x >> 3) >= cells_[0] || (y >> 3) >= cells_[1] || (z >> 3) >= cells_[2])
      return VoxelKind::kFree;
    const auto brick = static_cast<std::size_t>(brick_of(x >> 3, y >> 3, z >> 3));
    const unsigned bit = static_cast<unsigned>(2 * ((x & 7) + 8 * ((y & 7) + 8 * (z & 7))));
    return static_cast<VoxelKind>((bricks_[brick][bit >> 6] >> (bit & 63)) & 3U);
  }

  /// Sets one voxel within the range given at construction. Not real-time safe. A cell that gets
  /// its own brick may move those of other cells, here and below; in the order of `for_each_cell`
  /// none moves.
  void set(const VoxelIndex& v, VoxelKind kind);
  /// Sets the whole 8-voxel cell that contains `v` to one kind; free and interior use the shared
  /// brick.
  void fill_cell(const VoxelIndex& v, VoxelKind kind);
  /// Sets the whole 8-voxel cell that contains `v` from bits; surface takes precedence over
  /// interior, and voxels in neither are free.
  void set_cell(const VoxelIndex& v, const BrickMask& surface, const BrickMask& interior);
  /// Reserves memory for that many own bricks, so that filling them neither copies nor leaves spare
  /// memory.
  void reserve_bricks(std::size_t count) { bricks_.reserve(count + 2); }

  /// Calls f(x, y, z) for each 8-voxel cell of the table, relative to its first, in Morton order.
  template <class F>
  void for_each_cell(F&& f) const;

  /// Counts voxels, shares pages of uniform blocks, and computes the free-distance bytes and
  /// auxiliary tables. Call it after the last change; until then kernels use the previous state.
  void finish();

  /// Lower bound of the distance [voxels] from `u` (grid coordinates) to the nearest voxel that is
  /// not free; 0 if unknown (`finish` not called, NaN) or near. Outside the table at least the
  /// distance to the table. Real-time safe.
  double free_distance_voxels(const Vec3& u) const noexcept;

  /// Number of surface and interior voxels.
  std::size_t surface_count() const noexcept { return surface_count_; }
  std::size_t interior_count() const noexcept { return interior_count_; }
  /// Memory of all stored data.
  std::size_t bytes() const noexcept;
  /// Memory of the tables, included above.
  std::size_t table_bytes() const noexcept;

  /// Calls f(VoxelIndex, VoxelKind) for each voxel that is not free, sorted by (i, j, k).
  template <class F>
  void for_each_occupied(F&& f) const;

  /// Edge of a block [cells].
  static constexpr int kBlockEdge = 4;
  /// One code for each cell (x, y, z) of a block, at x + 4 (y + 4 z). Below 64: offset from the
  /// block's first brick. Otherwise, minus 64: the shared brick.
  using Page = std::array<std::uint8_t, 64>;
  static constexpr std::uint8_t kSharedCode = 64;
  /// A block of the table.
  struct Block {
    std::int32_t page, first_brick;
  };

  /// First voxel of the table and its size in 8-voxel cells.
  const VoxelIndex& base() const noexcept { return base_; }
  const std::array<std::int64_t, 3>& cells() const noexcept { return cells_; }

  static constexpr std::int64_t kMaxTableCells = std::int64_t{1} << 28;
  static constexpr std::size_t kFewTableBytes = std::size_t{1} << 19;

  static constexpr std::int32_t kFreeBrick = 0, kFreePage = 0;

  /// The arrays, for kernels that query many points at once. Valid during the lifetime of the map.
  struct Arrays {
    const Block* blocks;  ///< of 4x4x4 cells: x + blocks_along[0] (y + blocks_along[1] z)
    const Page* pages;
    /// Brick of the cell x + cells_along[0] (y + cells_along[1] z); null in a large map and until
    /// `finish`.
    const std::int32_t* table;
    std::array<std::int32_t, 2> blocks_along, cells_along;
    const Brick* bricks;
    std::size_t brick_count;
    /// free_distance of the cell (x free_cells[1] + y) free_cells[2] + z; null until `finish`.
    const std::uint8_t* free;
    int free_shift;  ///< log2 of such a cell's edge [voxels]
    std::array<std::int32_t, 3> free_cells;
  };
  Arrays arrays() const noexcept {
    const auto along = [](std::int64_t x, std::int64_t y) {
      return std::array{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
    };
    return {blocks_.data(),
            pages_.data(),
            table_.empty() ? nullptr : table_.data(),
            along(blocks_along(0), blocks_along(1)),
            along(cells_[0], cells_[1]),
            bricks_.data(),
            bricks_.size(),
            near_.empty() ? nullptr : near_.data(),
            near_shift_,
            {near_along(0), near_along(1), near_along(2)}};
  }

 private:
  static constexpr std::int32_t kInteriorBrick = 1, kInteriorPage = 1;
  /// Voxel relative to the first of the table.
  std::array<std::int64_t, 3> local(const VoxelIndex& v) const noexcept {
    return {std::int64_t{v.i} - base_.i, std::int64_t{v.j} - base_.j, std::int64_t{v.k} - base_.k};
  }
  std::int64_t blocks_along(std::size_t axis) const noexcept {
    return (cells_[axis] + kBlockEdge - 1) / kBlockEdge;
  }
  std::size_t block_index(std::int64_t x, std::int64_t y, std::int64_t z) const noexcept {
    return static_cast<std::size_t>((x >> 2) +
                                    blocks_along(0) * ((y >> 2) + blocks_along(1) * (z >> 2)));
  }
  static std::size_t place_in_page(std::int64_t x, std::int64_t y, std::int64_t z) noexcept {
    return static_cast<std::size_t>((x & 3) | (y & 3) << 2 | (z & 3) << 4);
  }
  std::int32_t brick_of(std::int64_t x, std::int64_t y, std::int64_t z) const noexcept {
    const Block& block = blocks_[block_index(x, y, z)];
    return brick_of(block, pages_[static_cast<std::size_t>(block.page)][place_in_page(x, y, z)]);
  }
  static std::int32_t brick_of(const Block& block, std::uint8_t code) noexcept {
    return code < kSharedCode ? block.first_brick + code : code - kSharedCode;
  }
  std::int32_t near_along(std::size_t axis) const noexcept {
    return static_cast<std::int32_t>(free_distance::cells_along(cells_[axis], near_shift_));
  }
  std::size_t near_index(std::int64_t x, std::int64_t y, std::int64_t z) const noexcept {
    return static_cast<std::size_t>((x * near_along(1) + y) * near_along(2) + z);
  }
  Page& own_page(Block& block);
  Brick& own_brick(std::int64_t x, std::int64_t y, std::int64_t z);
  void share_pages();
  void name_bricks();
  template <class F>
  void each_cell_from(std::int64_t x, std::int64_t y, std::int64_t z, std::int64_t edge,
                      F& f) const;
  void count_voxels() noexcept;
  void mark_brick(std::int64_t x, std::int64_t y, std::int64_t z,
                  free_distance::Occupancy& occupancy) const;

  Grid grid_;
  VoxelIndex base_;                      ///< first voxel of the table, a multiple of 8
  std::array<std::int64_t, 3> cells_{};  ///< table size in bricks
  std::vector<Block> blocks_;
  std::vector<Page> pages_;  ///< the two shared ones, then in the order of their bricks
  std::vector<std::int32_t> table_;
  std::vector<Brick, HugePages<Brick>> bricks_;
  std::vector<std::uint8_t> near_;  ///< free_distance bytes
  int near_shift_ = free_distance::kMinShift;
  std::size_t surface_count_ = 0, interior_count_ = 0;
};

template <class F>
void Voxmap::for_each_cell(F&& f) const {
  each_cell_from(0, 0, 0,
                 static_cast<std::int64_t>(
                     std::bit_ceil(static_cast<std::uint64_t>(std::ranges::max(cells_)))),
                 f);
}

template <class F>
void Voxmap::each_cell_from(std::int64_t x, std::int64_t y, std::int64_t z, std::int64_t edge,
                            F& f) const {
  if (x >= cells_[0] || y >= cells_[1] || z >= cells_[2])
    return;
  if (edge == 1)
    return f(x, y, z);
  const std::int64_t half = edge / 2;
  for (int n = 0; n < 8; ++n)
    each_cell_from(x + half * (n & 1), y + half * (n >> 1 & 1), z + half * (n >> 2), half, f);
}

template <class F>
void Voxmap::for_each_occupied(F&& f) const {
  for (std::int64_t x = 0; x < cells_[0] * kBrickEdge; ++x)
    for (std::int64_t y = 0; y < cells_[1] * kBrickEdge; ++y)
      for (std::int64_t cz = 0; cz < cells_[2]; ++cz) {
        if (brick_of(x >> 3, y >> 3, cz) == kFreeBrick)
          continue;
        for (std::int64_t z = cz * kBrickEdge; z < (cz + 1) * kBrickEdge; ++z) {
          const VoxelIndex v{static_cast<std::int32_t>(base_.i + x),
                             static_cast<std::int32_t>(base_.j + y),
                             static_cast<std::int32_t>(base_.k + z)};
          if (const VoxelKind kind = at(v); kind != VoxelKind::kFree)
            f(v, kind);
        }
      }
}

}  // namespace voxtouch::voxmap
