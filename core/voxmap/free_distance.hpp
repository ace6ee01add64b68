#pragma once
/// Lower bound of the distance to the nearest voxel that is not free, one byte for each cell of
/// 4x4x4 voxels, or more in a large table. The culling tree uses it.
#include <array>
#include <cstdint>
#include <vector>

#include "core/types/geometry.hpp"

namespace voxtouch::voxmap {

/// A byte is a lower bound of the distance from the *centre* of a cell to the nearest voxel that is
/// not free. Its unit is a quarter of the cell's edge (a step). Its resolution is quarters of a
/// step up to 24 steps, halves up to 64, and eight steps beyond, up to 696. At other points the
/// distance is smaller by at most the distance from the centre.
///
/// With cells of 4 voxels a step is one voxel. A table grows with the volume, a surface with the
/// area. If the bytes would exceed the number of surface voxels and `kFewBytes`, cells are twice as
/// long. The culling then keeps its resolution in metres.
namespace free_distance {

inline constexpr int kCellEdge = 4;                  ///< steps
inline constexpr int kMinShift = 2, kMaxShift = 12;  ///< log2 of a cell's edge [voxels]
inline constexpr std::size_t kFewBytes = std::size_t{1} << 20;

/// Cells along an axis of that many bricks of 8 voxels.
constexpr std::int64_t cells_along(std::int64_t bricks, int shift) noexcept {
  return (8 * bricks + (std::int64_t{1} << shift) - 1) >> shift;
}
/// Bytes of a table with that many bricks on each axis: a multiple of 4, as kernels read them.
constexpr std::size_t bytes_of(const std::array<std::int64_t, 3>& bricks, int shift) noexcept {
  return static_cast<std::size_t>((cells_along(bricks[0], shift) * cells_along(bricks[1], shift) *
                                       cells_along(bricks[2], shift) +
                                   3) /
                                  4 * 4);
}
/// log2 of the cell edge in such a table.
constexpr int shift_for(const std::array<std::int64_t, 3>& bricks,
                        std::size_t surface_voxels) noexcept {
  const std::size_t most = surface_voxels > kFewBytes ? surface_voxels : kFewBytes;
  int shift = kMinShift;
  while (shift < kMaxShift && bytes_of(bricks, shift) > most)
    ++shift;
  return shift;
}
/// Step length [voxels].
constexpr float step_of(int shift) noexcept { return static_cast<float>(1 << (shift - kMinShift)); }

/// Value of a byte [steps].
constexpr float steps(std::uint8_t byte) noexcept {
  const auto b = static_cast<float>(byte);
  const float fine = 0.25F * b, middle = 0.5F * b - 24.0F,
              coarse = 8.0F * b - 1344.0F;  // they meet at the bytes 96 and 176
  const float finer = fine > middle ? fine : middle;
  return finer > coarse ? finer : coarse;
}
/// The largest byte whose value is at most this.
constexpr std::uint8_t byte_of(double steps) noexcept {
  const double b = steps < 24.0   ? 4.0 * steps
                   : steps < 64.0 ? 2.0 * steps + 48.0
                                  : steps / 8.0 + 168.0;
  return b < 255.0 ? static_cast<std::uint8_t>(b) : 255;
}

/// Occupied parts of the grid, in halves of cells, two steps long: one bit each.
class Occupancy {
 public:
  /// For that many bricks of 8x8x8 voxels on each axis, and cells of 2^shift voxels.
  Occupancy(const std::array<std::int64_t, 3>& bricks, int shift);
  /// Marks occupied blocks of 2x2x2 voxels: bit z of `column` represents the voxels from (2 x, 2 y,
  /// 8 brick_z + 2 z) on, for the lower four bits.
  void mark(std::int64_t x, std::int64_t y, std::int64_t brick_z, unsigned column) noexcept {
    for (std::int64_t z = 4 * brick_z; column != 0; ++z, column >>= 1)
      if ((column & 1U) != 0)
        word(x >> halvings_, y >> halvings_, z >> halvings_) |= std::uint64_t{1}
                                                                << ((z >> halvings_) & 63);
  }
  /// The bytes, indexed (x * ny + y) * nz + z in cells. Exact for this occupancy up to 64 steps.
  /// Half a cell counts as a whole, so a bound is below the true distance by less than 2 sqrt(3)
  /// steps. Uses a few bytes per cell while it runs.
  std::vector<std::uint8_t> bytes() const;

 private:
  class Planes;
  std::uint64_t& word(std::int64_t x, std::int64_t y, std::int64_t z) noexcept {
    return bits_[static_cast<std::size_t>((x * n_[1] + y) * words_ + (z >> 6))];
  }
  int halvings_;                   ///< shift - kMinShift
  std::array<std::int64_t, 3> n_;  ///< halves of cells
  std::int64_t words_;             ///< of a row along z
  std::vector<std::uint64_t> bits_;
};

}  // namespace free_distance
}  // namespace voxtouch::voxmap
