#include "core/voxmap/voxmap.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>

namespace voxtouch {
namespace {

std::int32_t floor_to_brick(std::int64_t v) { return static_cast<std::int32_t>((v >> 3) << 3); }

constexpr std::uint8_t kFarthest = 255;
constexpr std::uint64_t kLowBits = 0x5555555555555555ULL;  // of each 2-bit voxel
constexpr std::uint64_t kLowX4 = 0x00ff00ff00ff00ffULL;    // voxels with x < 4 of a row

std::uint64_t all_of(VoxelKind kind) { return static_cast<std::uint64_t>(kind) * kLowBits; }

/// Bit n of the lower 32 goes to bit 2 n.
std::uint64_t every_other_bit(std::uint64_t bits) {
  bits &= 0xffffffffULL;
  bits = (bits | bits << 16) & 0x0000ffff0000ffffULL;
  bits = (bits | bits << 8) & 0x00ff00ff00ff00ffULL;
  bits = (bits | bits << 4) & 0x0f0f0f0f0f0f0f0fULL;
  bits = (bits | bits << 2) & 0x3333333333333333ULL;
  return (bits | bits << 1) & kLowBits;
}

}  // namespace

Voxmap::Voxmap(const Grid& grid, const VoxelIndex& first, const VoxelIndex& last) : grid_(grid) {
  constexpr std::int32_t kMaxIndex = 1 << 30;
  for (const std::int32_t n : {first.i, first.j, first.k, last.i, last.j, last.k})
    if (n < -kMaxIndex || n > kMaxIndex)
      throw std::length_error("voxmap: voxel indices beyond 2^30; put the grid's origin near the mesh");
  // One brick of border on every side, so that a point beside the object still finds a free brick.
  base_ = {floor_to_brick(std::int64_t{first.i} - kBrickEdge),
           floor_to_brick(std::int64_t{first.j} - kBrickEdge),
           floor_to_brick(std::int64_t{first.k} - kBrickEdge)};
  const auto count = [](std::int64_t base, std::int64_t end) { return ((end - base) >> 3) + 2; };
  cells_ = {count(base_.i, last.i), count(base_.j, last.j), count(base_.k, last.k)};
  // Each count is below 2^29, so the product of two fits int64 and the third is compared by division.
  if (cells_[0] * cells_[1] > kMaxTableCells / cells_[2])
    throw std::length_error("voxmap: the table would need more than 2^28 bricks; use a larger voxel size");
  table_.assign(static_cast<std::size_t>(cells_[0] * cells_[1] * cells_[2]), kFreeBrick);
  bricks_.resize(2);
  bricks_[kFreeBrick].fill(all_of(VoxelKind::kFree));
  bricks_[kInteriorBrick].fill(all_of(VoxelKind::kInterior));
}

Voxmap::Brick& Voxmap::own_brick(std::size_t index) {
  std::int32_t& entry = table_[index];
  if (entry == kFreeBrick || entry == kInteriorBrick) {
    bricks_.push_back(bricks_[static_cast<std::size_t>(entry)]);
    entry = static_cast<std::int32_t>(bricks_.size() - 1);
  }
  return bricks_[static_cast<std::size_t>(entry)];
}

void Voxmap::set(const VoxelIndex& v, VoxelKind kind) {
  const auto [x, y, z] = local(v);
  Brick& brick = own_brick(table_index(x >> 3, y >> 3, z >> 3));
  const unsigned bit = static_cast<unsigned>(2 * ((x & 7) + 8 * ((y & 7) + 8 * (z & 7))));
  std::uint64_t& word = brick[bit >> 6];
  word = (word & ~(std::uint64_t{3} << (bit & 63))) | (static_cast<std::uint64_t>(kind) << (bit & 63));
}

void Voxmap::fill_cell(const VoxelIndex& v, VoxelKind kind) {
  const auto [x, y, z] = local(v);
  const std::size_t index = table_index(x >> 3, y >> 3, z >> 3);
  const bool shared = table_[index] == kFreeBrick || table_[index] == kInteriorBrick;
  if (shared && kind != VoxelKind::kSurface)
    table_[index] = kind == VoxelKind::kInterior ? kInteriorBrick : kFreeBrick;
  else
    own_brick(index).fill(all_of(kind));
}

void Voxmap::set_cell(const VoxelIndex& v, const BrickMask& surface, const BrickMask& interior) {
  const auto [x, y, z] = local(v);
  Brick& brick = own_brick(table_index(x >> 3, y >> 3, z >> 3));
  for (std::size_t slice = 0; slice < 8; ++slice)
    for (std::size_t half = 0; half < 2; ++half) {
      const std::uint64_t s = surface[slice] >> (32 * half), n = interior[slice] & ~surface[slice];
      brick[2 * slice + half] = every_other_bit(s) | every_other_bit(n >> (32 * half)) << 1;
    }
}

void Voxmap::finish() {
  surface_count_ = interior_count_ = 0;
  bricks_.shrink_to_fit();
  near_cells_ = {cells_[0] * 2, cells_[1] * 2, cells_[2] * 2};
  near_.assign(static_cast<std::size_t>(near_cells_[0] * near_cells_[1] * near_cells_[2]), kFarthest);
  for (std::int64_t x = 0; x < cells_[0]; ++x)
    for (std::int64_t y = 0; y < cells_[1]; ++y)
      for (std::int64_t z = 0; z < cells_[2]; ++z) count_brick(x, y, z);
  spread_near();
}

void Voxmap::count_brick(std::int64_t x, std::int64_t y, std::int64_t z) {
  const std::int32_t entry = table_[table_index(x, y, z)];
  if (entry == kFreeBrick) return;
  const Brick& brick = bricks_[static_cast<std::size_t>(entry)];
  for (std::size_t word = 0; word < brick.size(); ++word) {
    surface_count_ += static_cast<std::size_t>(std::popcount(brick[word] & kLowBits));
    interior_count_ += static_cast<std::size_t>(std::popcount(brick[word] & ~kLowBits));
    // A word is half a slice: 8 voxels along x, 4 along y. Its low and high half bytes belong to different
    // 4-voxel cells.
    const auto half_y = static_cast<std::int64_t>(word & 1), half_z = static_cast<std::int64_t>(word >> 3);
    if ((brick[word] & kLowX4) != 0) near_[near_index(2 * x, 2 * y + half_y, 2 * z + half_z)] = 0;
    if ((brick[word] & ~kLowX4) != 0) near_[near_index(2 * x + 1, 2 * y + half_y, 2 * z + half_z)] = 0;
  }
}

/// Chessboard distance in cells: one sweep forward and one back over the 26 neighbours is exact for this
/// metric.
void Voxmap::spread_near() {
  const auto line = static_cast<std::size_t>(near_cells_[2]);
  // over the neighbours in lines already swept; one cell of margin each end
  std::vector<std::uint8_t> best(line + 2, kFarthest);
  const auto sweep_line = [&](std::int64_t x, std::int64_t y, int step) {
    std::fill(best.begin(), best.end(), kFarthest);
    const auto take = [&](std::int64_t nx, std::int64_t ny) {
      if (nx < 0 || nx >= near_cells_[0] || ny < 0 || ny >= near_cells_[1]) return;
      const std::uint8_t* const from = &near_[near_index(nx, ny, 0)];
      for (std::size_t z = 0; z < line; ++z) best[z + 1] = std::min(best[z + 1], from[z]);
    };
    for (int dy = -1; dy <= 1; ++dy) take(x - step, y + dy);
    take(x, y - step);
    std::uint8_t* const row = &near_[near_index(x, y, 0)];
    const auto farther = [](std::uint8_t d) { return d == kFarthest ? d : static_cast<std::uint8_t>(d + 1); };
    for (std::size_t z = 0; z < line; ++z)
      row[z] = std::min(row[z], farther(std::min(best[z], std::min(best[z + 1], best[z + 2]))));
    if (step > 0)
      for (std::size_t z = 1; z < line; ++z) row[z] = std::min(row[z], farther(row[z - 1]));
    else
      for (std::size_t z = line - 1; z-- > 0;) row[z] = std::min(row[z], farther(row[z + 1]));
  };
  for (std::int64_t x = 0; x < near_cells_[0]; ++x)
    for (std::int64_t y = 0; y < near_cells_[1]; ++y) sweep_line(x, y, 1);
  for (std::int64_t x = near_cells_[0]; x-- > 0;)
    for (std::int64_t y = near_cells_[1]; y-- > 0;) sweep_line(x, y, -1);
}

double Voxmap::free_distance_voxels(const Vec3& u) const noexcept {
  const Vec3 local = u - Vec3(base_.i, base_.j, base_.k);
  if (near_.empty() || local.hasNaN()) return 0.0;
  double outside = 0.0;
  std::array<std::int64_t, 3> cell{};
  for (int axis = 0; axis < 3; ++axis) {
    const double size = static_cast<double>(cells_[static_cast<std::size_t>(axis)] * kBrickEdge);
    outside = std::max({outside, -local[axis], local[axis] - size});
    cell[static_cast<std::size_t>(axis)] =
        static_cast<std::int64_t>(std::clamp(local[axis], 0.0, size - 1.0)) >> 2;
  }
  const std::uint8_t distance = near_[near_index(cell[0], cell[1], cell[2])];
  // A cell whose nearest occupied cell is n cells away is at least (n - 1) * 4 voxels from anything in it. A
  // point outside the table is no nearer to anything in the table than its projection onto the table is.
  return std::max(outside, distance == 0 ? 0.0 : (distance - 1) * static_cast<double>(kCellEdge));
}

std::size_t Voxmap::bytes() const noexcept {
  return table_.size() * sizeof(std::int32_t) + bricks_.size() * sizeof(Brick) + near_.size();
}

}  // namespace voxtouch
