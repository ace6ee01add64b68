/// Voxmaps and distance fields as bytes. What is read back may be anything: it is held against all that the lookups take for granted.
#include <algorithm>
#include <bit>
#include <cmath>

#include "core/types/stored_bytes.hpp"
#include "core/voxmap/distance_field.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch::voxmap {
namespace {

constexpr std::uint64_t kLowOfVoxels = 0x5555555555555555ULL;  // of each 2-bit voxel

/// Grid, first voxel and size in bricks of a table.
template <class Archive, class Grid, class Index, class Cells>
void placement(Archive& archive, Grid& grid, Index& base, Cells& cells) {
  archive(grid.origin), archive(grid.edge);
  archive(base.i), archive(base.j), archive(base.k);
  for (auto& count : cells) archive(count);
}

/// Throws unless a table may lie so, and has as many entries.
void require_table(const Grid& grid, const VoxelIndex& base, const std::array<std::int64_t, 3>& cells, std::size_t entries) {
  constexpr std::int64_t kMost = std::int64_t{1} << 30;
  ByteReader::require(grid.origin.allFinite() && std::isfinite(grid.edge) && grid.edge > 0.0, "a grid that is none");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t first = axis == 0 ? base.i : axis == 1 ? base.j : base.k;
    ByteReader::require(first >= -2 * kMost && first % 8 == 0 && cells[axis] > 0 && cells[axis] < kMost && first + 8 * cells[axis] <= 2 * kMost,
                        "a table that lies beyond all voxels");
  }
  ByteReader::require(cells[0] * cells[1] <= Voxmap::kMaxTableCells / cells[2], "a table that is too large");
  ByteReader::require(static_cast<std::int64_t>(entries) == cells[0] * cells[1] * cells[2], "a table of another size than it says");
}

bool all_within(const std::vector<std::int32_t>& table, std::int32_t least, std::size_t count) {
  return std::ranges::all_of(table, [=](std::int32_t entry) { return entry >= least && entry < static_cast<std::int64_t>(count); });
}

}  // namespace

template <class Archive, class Map>
void Voxmap::fields(Archive& archive, Map& map) {
  placement(archive, map.grid_, map.base_, map.cells_);
  archive(map.table_), archive(map.bricks_), archive(map.near_shift_), archive(map.near_);
  archive(map.surface_count_), archive(map.interior_count_);
}

void Voxmap::put(ByteWriter& out) const { fields(out, *this); }

Voxmap Voxmap::take(ByteReader& in) {
  Voxmap map;
  fields(in, map);
  require_table(map.grid_, map.base_, map.cells_, map.table_.size());
  ByteReader::require(map.near_shift_ >= free_distance::kLeastShift && map.near_shift_ <= free_distance::kMostShift &&
                          map.near_.size() == free_distance::bytes_of(map.cells_, map.near_shift_),
                      "free distances for another table");
  ByteReader::require(map.bricks_.size() >= 2 && all_within(map.table_, 0, map.bricks_.size()), "a table that names bricks which are not there");
  std::size_t surface = 0, interior = 0;
  std::vector<std::array<std::uint32_t, 2>> counts(map.bricks_.size(), {0, 0});
  for (std::size_t n = 0; n < map.bricks_.size(); ++n)
    for (const std::uint64_t word : map.bricks_[n]) {
      ByteReader::require((word & (word >> 1) & kLowOfVoxels) == 0, "a voxel of no kind");
      counts[n][0] += static_cast<std::uint32_t>(std::popcount(word & kLowOfVoxels)), counts[n][1] += static_cast<std::uint32_t>(std::popcount(word & ~kLowOfVoxels));
    }
  ByteReader::require(counts[kFreeBrick][0] + counts[kFreeBrick][1] == 0 && counts[kInteriorBrick][1] == 512, "shared bricks that are none");
  for (const std::int32_t entry : map.table_)
    surface += counts[static_cast<std::size_t>(entry)][0], interior += counts[static_cast<std::size_t>(entry)][1];
  ByteReader::require(surface == map.surface_count_ && interior == map.interior_count_, "other voxels than it counts");
  return map;
}

template <class Archive, class Field>
void DistanceField::fields(Archive& archive, Field& field) {
  placement(archive, field.grid_, field.base_, field.cells_);
  archive(field.table_), archive(field.bricks_);
  archive(field.depth_voxels_), archive(field.band_voxels_), archive(field.has_inside_), archive(field.steepest_gradient_);
}

void DistanceField::put(ByteWriter& out) const { fields(out, *this); }

DistanceField DistanceField::take(ByteReader& in) {
  DistanceField field;
  fields(in, field);
  require_table(field.grid_, field.base_, field.cells_, field.table_.size());
  ByteReader::require(all_within(field.table_, kDeep, field.bricks_.size()), "a table that names bricks which are not there");
  for (const double voxels : {field.depth_voxels_, field.band_voxels_})
    ByteReader::require(voxels >= 2.0 && voxels <= 1e4, "a depth or band that no field has");
  ByteReader::require(field.steepest_gradient_ >= 1.0 && field.steepest_gradient_ < 2.0, "a gradient that no distance has");
  const auto least = static_cast<float>(-field.depth_voxels_), most = static_cast<float>(field.band_voxels_);
  for (const Brick& brick : field.bricks_) {
    bool within = true;
    for (const float distance : brick) within = within & (distance >= least) & (distance <= most);
    ByteReader::require(within, "a distance beyond what the field holds");
  }
  return field;
}

}  // namespace voxtouch::voxmap
