#pragma once
/// How far the nearest voxel that is not free is at least, one byte for each cell of 4x4x4 voxels: what the culling tree asks.
#include <array>
#include <cstdint>
#include <vector>

#include "core/types/geometry.hpp"

namespace voxtouch::voxmap {

/// A byte is a lower bound of the distance from the cell's *centre* to the nearest voxel that is not free: in quarters of a voxel
/// up to 24 voxels, in halves up to 64, in steps of 8 beyond, to 696. Elsewhere the distance is smaller by at most the way from the
/// centre.
namespace free_distance {

inline constexpr int kCellEdge = 4;       ///< voxels

/// [voxels]
constexpr float voxels(std::uint8_t byte) noexcept {
  const auto b = static_cast<float>(byte);
  const float fine = 0.25F * b, middle = 0.5F * b - 24.0F, coarse = 8.0F * b - 1344.0F;  // they meet at the bytes 96 and 176
  const float finer = fine > middle ? fine : middle;
  return finer > coarse ? finer : coarse;
}
/// The largest byte that says no more than this.
constexpr std::uint8_t byte_of(double voxels) noexcept {
  const double b = voxels < 24.0 ? 4.0 * voxels : voxels < 64.0 ? 2.0 * voxels + 48.0 : voxels / 8.0 + 168.0;
  return b < 255.0 ? static_cast<std::uint8_t>(b) : 255;
}

/// What lies in which part of the grid, in cells of 2x2x2 voxels: one bit each, eight columns of bits a brick.
class Occupancy {
 public:
  /// Room for that many bricks of 8x8x8 voxels on each axis.
  explicit Occupancy(const std::array<std::int64_t, 3>& bricks);
  /// Marks 2x2x2-cells: bit z of `column` is the cell (x, y, 4 brick_z + z), for the lower four bits.
  void mark(std::int64_t x, std::int64_t y, std::int64_t brick_z, unsigned column) noexcept {
    const std::int64_t z = 4 * brick_z;
    word(x, y, z) |= static_cast<std::uint64_t>(column & 15U) << (z & 63);
  }
  /// The bytes, indexed (x * ny + y) * nz + z in 4-voxel cells. Exact for this occupancy up to 64 voxels; a 2x2x2-cell counts as
  /// a whole, so a bound falls short of the true distance by less than 2 sqrt(3) voxels. Takes a few bytes a cell while it works.
  std::vector<std::uint8_t> bytes() const;

 private:
  class Planes;
  std::uint64_t& word(std::int64_t x, std::int64_t y, std::int64_t z) noexcept {
    return bits_[static_cast<std::size_t>((x * n_[1] + y) * words_ + (z >> 6))];
  }
  std::array<std::int64_t, 3> n_;  ///< cells of 2 voxels
  std::int64_t words_;             ///< of a row along z
  std::vector<std::uint64_t> bits_;
};

}  // namespace free_distance
}  // namespace voxtouch::voxmap
