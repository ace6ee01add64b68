#include "core/voxmap/voxmap.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

namespace voxtouch::voxmap {
namespace {

std::int32_t floor_to_brick(std::int64_t v) { return static_cast<std::int32_t>((v >> 3) << 3); }

constexpr std::uint64_t kLowBits = 0x5555555555555555ULL;  // of each 2-bit voxel

std::uint64_t all_of(VoxelKind kind) { return static_cast<std::uint64_t>(kind) * kLowBits; }

/// Moves bit n of the lower 32 to bit 2 n.
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
      throw std::length_error(
          "voxmap: voxel indices exceed 2^30; choose a grid origin near the mesh");
  // One border brick on every side, so that a point next to the object still finds a free brick.
  base_ = {floor_to_brick(std::int64_t{first.i} - kBrickEdge),
           floor_to_brick(std::int64_t{first.j} - kBrickEdge),
           floor_to_brick(std::int64_t{first.k} - kBrickEdge)};
  const auto count = [](std::int64_t base, std::int64_t end) { return ((end - base) >> 3) + 2; };
  cells_ = {count(base_.i, last.i), count(base_.j, last.j), count(base_.k, last.k)};
  // Each count is below 2^29, so the product of two fits int64; the third is checked by division.
  if (cells_[0] * cells_[1] > kMaxTableCells / cells_[2])
    throw std::length_error("voxmap: the table exceeds 2^28 bricks; use a larger voxel size");
  blocks_.assign(static_cast<std::size_t>(blocks_along(0) * blocks_along(1) * blocks_along(2)),
                 {kFreePage, 0});
  pages_.resize(2);
  pages_[kFreePage].fill(kSharedCode + kFreeBrick);
  pages_[kInteriorPage].fill(kSharedCode + kInteriorBrick);
  bricks_.resize(2);
  bricks_[kFreeBrick].fill(all_of(VoxelKind::kFree));
  bricks_[kInteriorBrick].fill(all_of(VoxelKind::kInterior));
}

Voxmap::Page& Voxmap::own_page(Block& block) {
  if (block.page == kFreePage || block.page == kInteriorPage) {
    pages_.push_back(Page(pages_[static_cast<std::size_t>(block.page)]));
    block = {static_cast<std::int32_t>(pages_.size() - 1),
             static_cast<std::int32_t>(bricks_.size())};
  }
  return pages_[static_cast<std::size_t>(block.page)];
}

Voxmap::Brick& Voxmap::own_brick(std::int64_t x, std::int64_t y, std::int64_t z) {
  Block& block = blocks_[block_index(x, y, z)];
  Page& page = own_page(block);
  const std::size_t place = place_in_page(x, y, z);
  if (page[place] >= kSharedCode) {
    const auto shared = static_cast<std::size_t>(page[place] - kSharedCode);
    std::uint8_t before = 0;
    for (std::size_t n = 0; n < page.size(); ++n) {
      if (page[n] >= kSharedCode)
        continue;
      if (n < place)
        ++before;
      else
        ++page[n];
    }
    page[place] = before;
    bricks_.insert(bricks_.begin() + block.first_brick + before, Brick(bricks_[shared]));
    if (block.page + 1 < static_cast<std::int32_t>(pages_.size()))
      for (Block& other : blocks_)
        other.first_brick += other.page > block.page ? 1 : 0;
  }
  return bricks_[static_cast<std::size_t>(brick_of(block, page[place]))];
}

void Voxmap::set(const VoxelIndex& v, VoxelKind kind) {
  const auto [x, y, z] = local(v);
  Brick& brick = own_brick(x >> 3, y >> 3, z >> 3);
  const unsigned bit = static_cast<unsigned>(2 * ((x & 7) + 8 * ((y & 7) + 8 * (z & 7))));
  std::uint64_t& word = brick[bit >> 6];
  word =
      (word & ~(std::uint64_t{3} << (bit & 63))) | (static_cast<std::uint64_t>(kind) << (bit & 63));
}

void Voxmap::fill_cell(const VoxelIndex& v, VoxelKind kind) {
  const auto [i, j, k] = local(v);
  const std::int64_t x = i >> 3, y = j >> 3, z = k >> 3;
  const std::int32_t brick = brick_of(x, y, z),
                     requested = kind == VoxelKind::kInterior ? kInteriorBrick : kFreeBrick;
  if ((brick != kFreeBrick && brick != kInteriorBrick) || kind == VoxelKind::kSurface)
    own_brick(x, y, z).fill(all_of(kind));
  else if (brick != requested)
    own_page(blocks_[block_index(x, y, z)])[place_in_page(x, y, z)] =
        static_cast<std::uint8_t>(kSharedCode + requested);
}

void Voxmap::set_cell(const VoxelIndex& v, const BrickMask& surface, const BrickMask& interior) {
  const auto [x, y, z] = local(v);
  Brick& brick = own_brick(x >> 3, y >> 3, z >> 3);
  for (std::size_t slice = 0; slice < 8; ++slice)
    for (std::size_t half = 0; half < 2; ++half) {
      const std::uint64_t s = surface[slice] >> (32 * half), n = interior[slice] & ~surface[slice];
      brick[2 * slice + half] = every_other_bit(s) | every_other_bit(n >> (32 * half)) << 1;
    }
}

void Voxmap::finish() {
  share_pages();
  bricks_.shrink_to_fit();
  count_voxels();
  near_shift_ = free_distance::shift_for(cells_, surface_count_);
  free_distance::Occupancy occupancy(cells_, near_shift_);
  for_each_cell(
      [&](std::int64_t x, std::int64_t y, std::int64_t z) { mark_brick(x, y, z, occupancy); });
  near_ = occupancy.bytes();
  name_bricks();
}

void Voxmap::name_bricks() {
  table_.clear();
  const auto cells = static_cast<std::size_t>(cells_[0] * cells_[1] * cells_[2]);
  if (cells * sizeof(std::int32_t) > kFewTableBytes)
    return table_.shrink_to_fit();
  table_.reserve(cells);
  for (std::int64_t z = 0; z < cells_[2]; ++z)
    for (std::int64_t y = 0; y < cells_[1]; ++y)
      for (std::int64_t x = 0; x < cells_[0]; ++x)
        table_.push_back(brick_of(x, y, z));
}

void Voxmap::share_pages() {
  std::vector<std::int32_t> now(pages_.size());
  std::size_t kept = 0;
  for (std::size_t n = 0; n < pages_.size(); ++n) {
    if (n > kInteriorPage && pages_[n] == pages_[kFreePage])
      now[n] = kFreePage;
    else if (n > kInteriorPage && pages_[n] == pages_[kInteriorPage])
      now[n] = kInteriorPage;
    else
      pages_[kept] = pages_[n], now[n] = static_cast<std::int32_t>(kept++);
  }
  pages_.resize(kept);
  pages_.shrink_to_fit();
  for (Block& block : blocks_) {
    block.page = now[static_cast<std::size_t>(block.page)];
    if (block.page <= kInteriorPage)
      block.first_brick = 0;
  }
}

void Voxmap::count_voxels() noexcept {
  surface_count_ = interior_count_ = 0;
  for (const Block& block : blocks_)
    for (const std::uint8_t code : pages_[static_cast<std::size_t>(block.page)]) {
      const std::int32_t brick = brick_of(block, code);
      if (brick == kFreeBrick)
        continue;
      for (const std::uint64_t word : bricks_[static_cast<std::size_t>(brick)]) {
        surface_count_ += static_cast<std::size_t>(std::popcount(word & kLowBits));
        interior_count_ += static_cast<std::size_t>(std::popcount(word & ~kLowBits));
      }
    }
}

void Voxmap::mark_brick(std::int64_t x, std::int64_t y, std::int64_t z,
                        free_distance::Occupancy& occupancy) const {
  const std::int32_t number = brick_of(x, y, z);
  if (number == kFreeBrick)
    return;
  const Brick& brick = bricks_[static_cast<std::size_t>(number)];
  std::array<std::array<unsigned, 4>, 4> columns{};  // of 2x2x2-cells along z
  for (std::size_t word = 0; word < brick.size(); ++word) {
    // A word is half a slice: 8 voxels along x, 4 along y; 16 bits per row of x, 4 bits per pair of
    // voxels.
    const std::uint64_t rows[2] = {brick[word] | brick[word] >> 16,
                                   brick[word] >> 32 | brick[word] >> 48};
    for (std::size_t y2 = 0; y2 < 2; ++y2)
      for (std::size_t x2 = 0; x2 < 4; ++x2)
        if ((rows[y2] >> (4 * x2) & 15U) != 0)
          columns[x2][2 * (word & 1) + y2] |= 1U << (word >> 2);
  }
  for (std::int64_t x2 = 0; x2 < 4; ++x2)
    for (std::int64_t y2 = 0; y2 < 4; ++y2)
      occupancy.mark(4 * x + x2, 4 * y + y2, z,
                     columns[static_cast<std::size_t>(x2)][static_cast<std::size_t>(y2)]);
}

double Voxmap::free_distance_voxels(const Vec3& u) const noexcept {
  const Vec3 local = u - Vec3(base_.i, base_.j, base_.k);
  if (near_.empty() || local.hasNaN())
    return 0.0;
  double outside = 0.0, squared = 0.0;
  std::array<std::int64_t, 3> cell{};
  for (int axis = 0; axis < 3; ++axis) {
    const double size = static_cast<double>(cells_[static_cast<std::size_t>(axis)] * kBrickEdge);
    outside = std::max({outside, -local[axis], local[axis] - size});
    const auto nearest =
        static_cast<std::int64_t>(std::clamp(local[axis], 0.0, size - 1.0)) >> near_shift_;
    const double edge = static_cast<double>(1 << near_shift_),
                 distance = local[axis] - edge * (static_cast<double>(nearest) + 0.5);
    squared += distance * distance;
    cell[static_cast<std::size_t>(axis)] = nearest;
  }
  // A distance decreases no faster than the displacement from the cell's centre. A point outside
  // the table is no nearer to any voxel than its projection onto the table.
  const double from_centre = free_distance::step_of(near_shift_) *
                             free_distance::steps(near_[near_index(cell[0], cell[1], cell[2])]);
  return std::max(outside, from_centre - std::sqrt(squared));
}

std::size_t Voxmap::table_bytes() const noexcept {
  return blocks_.size() * sizeof(Block) + pages_.size() * sizeof(Page) +
         table_.size() * sizeof(std::int32_t);
}

std::size_t Voxmap::bytes() const noexcept {
  return table_bytes() + bricks_.size() * sizeof(Brick) + near_.size();
}

}  // namespace voxtouch::voxmap
