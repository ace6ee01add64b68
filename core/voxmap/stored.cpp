/// Voxmaps and distance fields as bytes. What is read back may be anything: it is checked for all
/// that the lookups take for granted.
#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "core/types/stored_bytes.hpp"
#include "core/voxmap/distance_field.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch {
/// Goes as it lies in memory.
template <>
struct stored_bytes::IsPlainRow<voxmap::Voxmap::Block>
    : std::has_unique_object_representations<voxmap::Voxmap::Block> {};
}  // namespace voxtouch

namespace voxtouch::voxmap {
namespace {

constexpr std::uint64_t kLowOfVoxels = 0x5555555555555555ULL;  // of each 2-bit voxel

/// Grid, first voxel and size in bricks of a table.
template <class Archive, class Grid, class Index, class Cells>
void placement(Archive& archive, Grid& grid, Index& base, Cells& cells) {
  archive(grid.origin), archive(grid.edge);
  archive(base.i), archive(base.j), archive(base.k);
  for (auto& count : cells)
    archive(count);
}

/// Throws unless a table may lie so.
void require_table(const Grid& grid, const VoxelIndex& base,
                   const std::array<std::int64_t, 3>& cells) {
  constexpr std::int64_t kMax = std::int64_t{1} << 30;
  ByteReader::require(grid.origin.allFinite() && std::isfinite(grid.edge) && grid.edge > 0.0,
                      "a grid that is none");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t first = axis == 0 ? base.i : axis == 1 ? base.j : base.k;
    ByteReader::require(first >= -2 * kMax && first % 8 == 0 && cells[axis] > 0 &&
                            cells[axis] < kMax && first + 8 * cells[axis] <= 2 * kMax,
                        "a table that lies beyond all voxels");
  }
  ByteReader::require(cells[0] * cells[1] <= Voxmap::kMaxTableCells / cells[2],
                      "a table that is too large");
}

constexpr const char* kAnotherSize = "a table of another size than it says";
constexpr const char* kNoSuchBrick = "a table that names bricks which are not there";

}  // namespace

template <class Archive, class Map>
void Voxmap::fields(Archive& archive, Map& map) {
  placement(archive, map.grid_, map.base_, map.cells_);
  archive(map.blocks_), archive(map.pages_), archive(map.bricks_), archive(map.near_shift_),
      archive(map.near_);
  archive(map.surface_count_), archive(map.interior_count_);
}

void Voxmap::put(ByteWriter& out) const { fields(out, *this); }

Voxmap Voxmap::take(ByteReader& in) {
  Voxmap map;
  fields(in, map);
  require_table(map.grid_, map.base_, map.cells_);
  ByteReader::require(static_cast<std::int64_t>(map.blocks_.size()) ==
                          map.blocks_along(0) * map.blocks_along(1) * map.blocks_along(2),
                      kAnotherSize);
  ByteReader::require(map.near_shift_ >= free_distance::kMinShift &&
                          map.near_shift_ <= free_distance::kMaxShift &&
                          map.near_.size() == free_distance::bytes_of(map.cells_, map.near_shift_),
                      "free distances for another table");
  ByteReader::require(map.bricks_.size() >= 2 && map.pages_.size() >= 2, kNoSuchBrick);
  const Voxmap none(map.grid_, {}, {});
  ByteReader::require(std::ranges::equal(none.pages_, std::span(map.pages_).first(2)),
                      "shared pages that are none");
  std::vector<std::int64_t> most_of_page(map.pages_.size(), -1);
  for (std::size_t n = 0; n < map.pages_.size(); ++n)
    for (const std::uint8_t code : map.pages_[n]) {
      ByteReader::require(code <= kSharedCode + kInteriorBrick, kNoSuchBrick);
      if (code < kSharedCode)
        most_of_page[n] = std::max<std::int64_t>(most_of_page[n], code);
    }
  for (const Block& block : map.blocks_) {
    ByteReader::require(
        block.page >= 0 && block.page < static_cast<std::int64_t>(map.pages_.size()),
        "a table that names pages which are not there");
    const std::int64_t last =
        block.first_brick + most_of_page[static_cast<std::size_t>(block.page)];
    ByteReader::require(
        block.first_brick >= 0 && last < static_cast<std::int64_t>(map.bricks_.size()),
        kNoSuchBrick);
  }
  std::size_t surface = 0, interior = 0;
  std::vector<std::array<std::uint32_t, 2>> counts(map.bricks_.size(), {0, 0});
  for (std::size_t n = 0; n < map.bricks_.size(); ++n)
    for (const std::uint64_t word : map.bricks_[n]) {
      ByteReader::require((word & (word >> 1) & kLowOfVoxels) == 0, "a voxel of no kind");
      counts[n][0] += static_cast<std::uint32_t>(std::popcount(word & kLowOfVoxels)),
          counts[n][1] += static_cast<std::uint32_t>(std::popcount(word & ~kLowOfVoxels));
    }
  ByteReader::require(
      counts[kFreeBrick][0] + counts[kFreeBrick][1] == 0 && counts[kInteriorBrick][1] == 512,
      "shared bricks that are none");
  for (const Block& block : map.blocks_)
    for (const std::uint8_t code : map.pages_[static_cast<std::size_t>(block.page)]) {
      const auto& count = counts[static_cast<std::size_t>(brick_of(block, code))];
      surface += count[0], interior += count[1];
    }
  ByteReader::require(surface == map.surface_count_ && interior == map.interior_count_,
                      "other voxels than it counts");
  map.name_bricks();
  return map;
}

template <class Archive, class Field>
void DistanceField::fields(Archive& archive, Field& field) {
  placement(archive, field.grid_, field.base_, field.cells_);
  archive(field.table_), archive(field.bricks_);
  archive(field.depth_voxels_), archive(field.band_voxels_), archive(field.has_inside_),
      archive(field.steepest_gradient_);
}

void DistanceField::put(ByteWriter& out) const { fields(out, *this); }

DistanceField DistanceField::take(ByteReader& in) {
  DistanceField field;
  fields(in, field);
  require_table(field.grid_, field.base_, field.cells_);
  ByteReader::require(static_cast<std::int64_t>(field.table_.size()) ==
                          field.cells_[0] * field.cells_[1] * field.cells_[2],
                      kAnotherSize);
  const auto bricks = static_cast<std::int64_t>(field.bricks_.size());
  ByteReader::require(
      std::ranges::all_of(field.table_,
                          [=](std::int32_t entry) { return entry >= kDeep && entry < bricks; }),
      kNoSuchBrick);
  for (const double voxels : {field.depth_voxels_, field.band_voxels_})
    ByteReader::require(voxels >= 2.0 && voxels <= 1e4, "a depth or band that no field has");
  ByteReader::require(field.steepest_gradient_ >= 1.0 && field.steepest_gradient_ < 2.0,
                      "a gradient that no distance has");
  const auto least = static_cast<float>(-field.depth_voxels_),
             most = static_cast<float>(field.band_voxels_);
  for (const Brick& brick : field.bricks_) {
    bool within = true;
    for (const float distance : brick)
      within = within & (distance >= least) & (distance <= most);
    ByteReader::require(within, "a distance beyond what the field holds");
  }
  return field;
}

}  // namespace voxtouch::voxmap
