#include "core/voxmap/voxmap.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>

namespace voxtouch {
namespace {

std::int32_t floor_to_brick(std::int64_t v) { return static_cast<std::int32_t>((v >> 3) << 3); }

std::uint64_t all_of(VoxelKind kind) {
  return kind == VoxelKind::kFree ? 0 : static_cast<std::uint64_t>(kind) * 0x5555555555555555ULL;
}

}  // namespace

Voxmap::Voxmap(const Grid& grid, const VoxelIndex& first, const VoxelIndex& last) : grid_(grid) {
  // One brick of border on every side, so that a point beside the object still finds a free brick.
  base_ = {floor_to_brick(std::int64_t{first.i} - kBrickEdge), floor_to_brick(std::int64_t{first.j} - kBrickEdge),
           floor_to_brick(std::int64_t{first.k} - kBrickEdge)};
  const auto count = [](std::int64_t base, std::int64_t end) { return ((end - base) >> 3) + 2; };
  cells_ = {count(base_.i, last.i), count(base_.j, last.j), count(base_.k, last.k)};
  shift_y_ = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(cells_[0] - 1)));
  shift_z_ = shift_y_ + static_cast<int>(std::bit_width(static_cast<std::uint64_t>(cells_[1] - 1)));
  if (shift_z_ > 40 || (cells_[2] << shift_z_) > kMaxTableCells)
    throw std::length_error("voxmap: the table would need more than 2^28 bricks; use a larger voxel size");
  table_.assign(static_cast<std::size_t>(cells_[2] << shift_z_), kFreeBrick);
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
  const std::int64_t x = v.i - base_.i, y = v.j - base_.j, z = v.k - base_.k;
  Brick& brick = own_brick(table_index(x >> 3, y >> 3, z >> 3));
  const unsigned bit = static_cast<unsigned>(2 * ((x & 7) + 8 * ((y & 7) + 8 * (z & 7))));
  std::uint64_t& word = brick[bit >> 6];
  word = (word & ~(std::uint64_t{3} << (bit & 63))) | (static_cast<std::uint64_t>(kind) << (bit & 63));
}

void Voxmap::fill_cell(const VoxelIndex& v, VoxelKind kind) {
  const std::int64_t x = v.i - base_.i, y = v.j - base_.j, z = v.k - base_.k;
  std::int32_t& entry = table_[table_index(x >> 3, y >> 3, z >> 3)];
  if (entry == kFreeBrick || entry == kInteriorBrick)
    entry = kind == VoxelKind::kInterior ? kInteriorBrick : kFreeBrick;
  else
    bricks_[static_cast<std::size_t>(entry)].fill(all_of(kind));
}

void Voxmap::finish() {
  surface_count_ = interior_count_ = 0;
  near_cells_ = {cells_[0] * 2, cells_[1] * 2, cells_[2] * 2};
  const auto near_index = [this](std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<std::size_t>((x * near_cells_[1] + y) * near_cells_[2] + z);
  };
  near_.assign(static_cast<std::size_t>(near_cells_[0] * near_cells_[1] * near_cells_[2]), 255);
  for_each_occupied([&](const VoxelIndex& v, VoxelKind kind) {
    (kind == VoxelKind::kSurface ? surface_count_ : interior_count_) += 1;
    near_[near_index((v.i - base_.i) >> 2, (v.j - base_.j) >> 2, (v.k - base_.k) >> 2)] = 0;
  });
  // Chessboard distance in cells, exact, by one forward and one backward sweep along each axis in turn.
  const auto sweep = [&](int axis) {
    std::array<std::int64_t, 3> n = near_cells_;
    for (std::int64_t a = 0; a < n[(axis + 1) % 3]; ++a)
      for (std::int64_t b = 0; b < n[(axis + 2) % 3]; ++b) {
        // min over the line of max(|offset|, value): chessboard distance is separable in this way.
        std::vector<std::uint8_t> line(static_cast<std::size_t>(n[axis])), out(line.size());
        const auto cell = [&](std::int64_t t) -> std::uint8_t& {
          std::array<std::int64_t, 3> c{};
          c[axis] = t, c[(axis + 1) % 3] = a, c[(axis + 2) % 3] = b;
          return near_[near_index(c[0], c[1], c[2])];
        };
        for (std::int64_t t = 0; t < n[axis]; ++t) line[static_cast<std::size_t>(t)] = cell(t);
        for (std::int64_t t = 0; t < n[axis]; ++t) {
          std::int64_t best = line[static_cast<std::size_t>(t)];
          for (std::int64_t d = 1; d < best; ++d) {
            if (t - d >= 0) best = std::min(best, std::max<std::int64_t>(d, line[static_cast<std::size_t>(t - d)]));
            if (t + d < n[axis]) best = std::min(best, std::max<std::int64_t>(d, line[static_cast<std::size_t>(t + d)]));
          }
          out[static_cast<std::size_t>(t)] = static_cast<std::uint8_t>(best);
        }
        for (std::int64_t t = 0; t < n[axis]; ++t) cell(t) = out[static_cast<std::size_t>(t)];
      }
  };
  for (int axis = 0; axis < 3; ++axis) sweep(axis);
}

double Voxmap::free_distance_voxels(const Vec3& u) const noexcept {
  const Vec3 local = u - Vec3(base_.i, base_.j, base_.k);
  double outside = 0.0;
  std::array<std::int64_t, 3> cell{};
  for (int axis = 0; axis < 3; ++axis) {
    const double size = static_cast<double>(cells_[static_cast<std::size_t>(axis)] * kBrickEdge);
    if (!(local[axis] >= 0.0)) outside = std::max(outside, -local[axis]);
    if (!(local[axis] < size)) outside = std::max(outside, local[axis] - size);
    const double clamped = std::clamp(local[axis], 0.0, size - 1.0);
    cell[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(clamped) >> 2;
  }
  const auto distance =
      near_[static_cast<std::size_t>((cell[0] * near_cells_[1] + cell[1]) * near_cells_[2] + cell[2])];
  // A cell whose nearest occupied cell is n cells away is at least (n - 1) * 4 voxels from anything in it.
  const double inside = distance == 0 ? 0.0 : (distance - 1) * static_cast<double>(kCellEdge);
  return std::max(outside, inside);
}

std::size_t Voxmap::bytes() const noexcept {
  return table_.size() * sizeof(std::int32_t) + bricks_.size() * sizeof(Brick) + near_.size();
}

}  // namespace voxtouch
