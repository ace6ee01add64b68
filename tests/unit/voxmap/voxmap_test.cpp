#include "core/voxmap/voxmap.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "core/voxmap/brick_bits.hpp"

namespace voxtouch::voxmap {
namespace {

VoxelIndex random_voxel(std::mt19937& random, int low, int high) {
  std::uniform_int_distribution<int> pick(low, high);
  return {pick(random), pick(random), pick(random)};
}

TEST(Voxmap, KeepsWhatWasSetAlsoAtNegativeIndices) {
  std::mt19937 random(3);
  Voxmap map({}, {-37, -8, -1}, {20, 9, 31});
  std::map<VoxelIndex, VoxelKind> expected;
  for (int n = 0; n < 3000; ++n) {
    VoxelIndex v = random_voxel(random, -37, 31);
    v = {std::min(v.i, 20), std::clamp(v.j, -8, 9), std::max(v.k, -1)};
    const auto kind = static_cast<VoxelKind>(random() % 3);
    map.set(v, kind);
    expected[v] = kind;
  }
  for (int i = -50; i < 40; ++i)
    for (int j = -25; j < 30; ++j)
      for (int k = -20; k < 50; ++k) {
        const auto found = expected.find({i, j, k});
        ASSERT_EQ(map.at({i, j, k}), found == expected.end() ? VoxelKind::kFree : found->second);
      }
  EXPECT_EQ(map.at({INT32_MIN, INT32_MIN, INT32_MIN}), VoxelKind::kFree);
  EXPECT_EQ(map.at({INT32_MAX, INT32_MAX, INT32_MAX}), VoxelKind::kFree);
}

TEST(Voxmap, VisitsOccupiedVoxelsInOrderAndCountsThem) {
  std::mt19937 random(4);
  Voxmap map({}, {-20, -20, -20}, {20, 20, 20});
  map.fill_cell({-3, 5, 7}, VoxelKind::kInterior);
  map.fill_cell({9, 9, 9}, VoxelKind::kSurface);
  std::set<VoxelIndex> expected;
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y)
      for (int z = 0; z < 8; ++z)
        expected.insert({-8 + x, y, z}), expected.insert({8 + x, 8 + y, 8 + z});
  for (int n = 0; n < 500; ++n) {
    const VoxelIndex v = random_voxel(random, -20, 20);
    map.set(v, VoxelKind::kSurface);
    expected.insert(v);
  }
  map.finish();
  std::vector<VoxelIndex> visited;
  std::size_t surface = 0;
  map.for_each_occupied([&](const VoxelIndex& v, VoxelKind kind) {
    visited.push_back(v);
    surface += kind == VoxelKind::kSurface;
  });
  EXPECT_EQ(visited, std::vector<VoxelIndex>(expected.begin(), expected.end()));
  EXPECT_EQ(map.surface_count(), surface);
  EXPECT_EQ(map.surface_count() + map.interior_count(), expected.size());
  map.fill_cell({9, 9, 9}, VoxelKind::kFree);
  EXPECT_EQ(map.at({8, 15, 12}), VoxelKind::kFree);
}

TEST(Voxmap, SetsACellFromBitsWithSurfaceOverInterior) {
  std::mt19937_64 random(5);
  BrickMask surface, interior;
  for (std::size_t z = 0; z < 8; ++z)
    surface[z] = random() & random(), interior[z] = random();
  Voxmap map({}, {0, 0, 0}, {20, 20, 20});
  map.set_cell({8, 8, 8}, surface, interior);
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y)
      for (int z = 0; z < 8; ++z) {
        const auto bit = [&](const BrickMask& m) {
          return (m[static_cast<std::size_t>(z)] >> (x + 8 * y)) & 1;
        };
        const VoxelKind expected = bit(surface)    ? VoxelKind::kSurface
                                   : bit(interior) ? VoxelKind::kInterior
                                                   : VoxelKind::kFree;
        ASSERT_EQ(map.at({8 + x, 8 + y, 8 + z}), expected);
      }
}

VoxelIndex first_of_cell(const Voxmap& map, std::int64_t x, std::int64_t y, std::int64_t z) {
  return {static_cast<std::int32_t>(map.base().i + 8 * x),
          static_cast<std::int32_t>(map.base().j + 8 * y),
          static_cast<std::int32_t>(map.base().k + 8 * z)};
}

/// Data of the kernels: the table of a small map and the pages of any name the brick of each voxel,
/// in any order of the cells.
TEST(Voxmap, PagesAndTableNameTheSameBricks) {
  std::mt19937 random(9);
  for (const bool in_order : {true, false}) {
    Voxmap map({}, {-70, -70, -70}, {70, 70, 70});
    const Voxmap::Arrays before = map.arrays();
    EXPECT_EQ(before.table, nullptr);
    std::vector<VoxelIndex> listed;
    map.for_each_cell([&](std::int64_t x, std::int64_t y, std::int64_t z) {
      const VoxelIndex v = first_of_cell(map, x, y, z);
      if (v.i < -70 || v.j < -70 || v.k < -70 || v.i > 62 || v.j > 62 || v.k > 62)
        return;
      if (x > 11 && y > 11 && z > 11)
        map.fill_cell(v, VoxelKind::kInterior);  // whole blocks among them
      else if (random() % 5 == 0)
        listed.push_back(v);
    });
    if (!in_order)
      std::ranges::shuffle(listed, random);
    for (const VoxelIndex& v : listed)
      map.set(v, VoxelKind::kSurface);
    map.finish();
    const Voxmap::Arrays a = map.arrays();
    ASSERT_NE(a.table, nullptr);
    ASSERT_EQ(a.brick_count, listed.size() + 2);
    std::int32_t last = 1;
    map.for_each_cell([&](std::int64_t x, std::int64_t y, std::int64_t z) {
      const Voxmap::Block block =
          a.blocks[(x >> 2) + a.blocks_along[0] * ((y >> 2) + a.blocks_along[1] * (z >> 2))];
      const std::int32_t code =
          a.pages[block.page][static_cast<std::size_t>((x & 3) | (y & 3) << 2 | (z & 3) << 4)];
      const std::int32_t brick =
          code < Voxmap::kSharedCode ? block.first_brick + code : code - Voxmap::kSharedCode;
      ASSERT_EQ(brick, a.table[x + a.cells_along[0] * (y + a.cells_along[1] * z)]);
      ASSERT_LT(brick, static_cast<std::int32_t>(a.brick_count));
      last = std::max(last, brick);
    });
    EXPECT_EQ(last + 1, static_cast<std::int32_t>(a.brick_count));
    for (const VoxelIndex& v : listed)
      ASSERT_EQ(map.at(v), VoxelKind::kSurface);
    EXPECT_EQ(map.surface_count(), listed.size());
  }
}

TEST(Voxmap, BlocksWithoutSurfaceUseOnePage) {
  Voxmap map({}, {0, 0, 0}, {255, 255, 255});
  map.for_each_cell([&](std::int64_t x, std::int64_t y, std::int64_t z) {
    if (x > 0 && y > 0 && z > 0 && x < 33 && y < 33 && z < 33)
      map.fill_cell(first_of_cell(map, x, y, z), VoxelKind::kInterior);
  });
  map.finish();
  const Voxmap::Arrays a = map.arrays();
  const auto blocks = static_cast<std::size_t>(a.blocks_along[0] * a.blocks_along[1]) * 9;
  const std::size_t inside = 7 * 7 * 7, table = a.table == nullptr ? 0 : 4 * 34 * 34 * 34;
  EXPECT_EQ(map.interior_count(), std::size_t{32} * 32 * 32 * 512);
  EXPECT_LE(map.table_bytes(), table + 8 * blocks + sizeof(Voxmap::Page) * (2 + blocks - inside));
  EXPECT_EQ(map.at({100, 100, 100}), VoxelKind::kInterior);
}

/// Distance from a point to the nearest point of a closed voxel.
double distance_to(const VoxelIndex& v, const Vec3& u) {
  const Vec3 low(v.i, v.j, v.k);
  return (u - u.cwiseMax(low).cwiseMin(low + Vec3::Ones())).norm();
}

TEST(Voxmap, FreeDistanceIsALowerBoundEverywhere) {
  std::mt19937 random(6);
  for (const int count : {1, 2, 5, 60}) {
    Voxmap map({}, {-30, -30, -30}, {90, 40, 35});
    std::vector<VoxelIndex> occupied;
    for (int n = 0; n < count; ++n) {
      occupied.push_back(random_voxel(random, -30, 35));
      map.set(occupied.back(), n % 2 ? VoxelKind::kSurface : VoxelKind::kInterior);
    }
    map.finish();
    std::uniform_real_distribution<double> pick(-80.0, 130.0);
    double closest = 1e9, tightest = 1e9;
    for (int n = 0; n < 20000; ++n) {
      const Vec3 u(pick(random), pick(random), pick(random));
      double nearest = 1e9;
      for (const VoxelIndex& v : occupied)
        nearest = std::min(nearest, distance_to(v, u));
      const double bound = map.free_distance_voxels(u);
      ASSERT_LE(bound, nearest) << u.transpose();
      closest = std::min(closest, nearest - bound);
      // Not a feeble one: the true chessboard distance is less than three cells more within the
      // table.
      if ((u.array() > -39.0).all() && (u.array() < 40.0).all())
        tightest = std::min(tightest, bound - nearest / 1.7320508 + 12.0);
    }
    EXPECT_GE(tightest, 0.0);
    for (const VoxelIndex& v : occupied)
      EXPECT_EQ(map.free_distance_voxels(Vec3(v.i + 0.5, v.j + 0.5, v.k + 0.5)), 0.0);
  }
}

/// For a table much larger than its surface: cells are longer, so that bytes stay few, and bounds
/// are coarser by the same factor.
TEST(Voxmap, FreeDistanceTakesLongerCellsInALargeTable) {
  std::mt19937 random(7);
  Voxmap map({}, {0, 0, 0}, {1100, 1100, 1100});
  std::vector<VoxelIndex> occupied;
  for (int n = 0; n < 40; ++n) {
    occupied.push_back(random_voxel(random, 0, 1100));
    map.set(occupied.back(), n % 2 ? VoxelKind::kSurface : VoxelKind::kInterior);
  }
  map.finish();
  ASSERT_GT(map.arrays().free_shift, free_distance::kMinShift);
  const double step = free_distance::step_of(map.arrays().free_shift);
  EXPECT_LE(map.table_bytes(),
            static_cast<std::size_t>(map.cells()[0] * map.cells()[1] * map.cells()[2]) / 6 +
                42 * sizeof(Voxmap::Page));
  EXPECT_LE(map.bytes(), map.table_bytes() + 42 * sizeof(Voxmap::Brick) + free_distance::kFewBytes);
  std::uniform_real_distribution<double> pick(-200.0, 1300.0);
  for (int n = 0; n < 20000; ++n) {
    const Vec3 u(pick(random), pick(random), pick(random));
    double nearest = 1e9;
    for (const VoxelIndex& v : occupied)
      nearest = std::min(nearest, distance_to(v, u));
    const double bound = map.free_distance_voxels(u);
    ASSERT_LE(bound, nearest) << u.transpose();
    // Within the exact reach: the path to a cell's centre and back, the rest of a voxel's half of a
    // cell, the steps of the byte.
    if (nearest < 50.0 * step && (u.array() > 0.0).all() && (u.array() < 1100.0).all()) {
      ASSERT_GE(bound, nearest - step * (4.0 * std::sqrt(3.0) + 2.0 * std::sqrt(3.0) + 0.5))
          << u.transpose();
    }
  }
}

TEST(Voxmap, FreeDistanceFallsShortOfTheTruthByLittle) {
  Voxmap map({}, {0, 0, 0}, {60, 60, 60});
  map.set({32, 0, 0}, VoxelKind::kSurface);
  map.finish();
  const double bound = map.free_distance_voxels(Vec3(8.1, 0, 0));
  // By the path to the cell's centre and back, at most, and by the neighbours in its 2x2x2-cell.
  EXPECT_LE(bound, 32.0 - 8.1);
  EXPECT_GE(bound, 32.0 - 8.1 - 2.0 * 2.0 * std::sqrt(3.0) - 0.25);
}

TEST(Voxmap, UnknownFreeDistanceIsZero) {
  EXPECT_EQ(Voxmap().free_distance_voxels(Vec3(1, 2, 3)), 0.0);
  Voxmap map({}, {0, 0, 0}, {60, 60, 60});
  map.set({32, 0, 0}, VoxelKind::kSurface);
  EXPECT_EQ(map.free_distance_voxels(Vec3(1, 50, 50)), 0.0);
  map.finish();
  EXPECT_EQ(map.free_distance_voxels(Vec3(1, NAN, 3)), 0.0);
  EXPECT_TRUE(map.free_distance_voxels(Vec3(1e300, 0, 0)) >= 1e299);
}

TEST(Voxmap, RefusesAnInvalidTable) {
  EXPECT_THROW(Voxmap({}, {0, 0, 0}, {100000, 100000, 100000}), std::length_error);
  EXPECT_THROW(Voxmap({}, {INT32_MIN, 0, 0}, {0, 0, 0}), std::length_error);
}

TEST(BrickBits, GrowFollowsFacesOnly) {
  std::mt19937_64 random(8);
  for (int n = 0; n < 200; ++n) {
    BrickMask room;
    for (auto& word : room)
      word = random() | random();
    BrickMask seed{};
    seed[3] = room[3] & (~room[3] + 1);
    std::set<int> reached, open;
    for (int v = 0; v < 512; ++v)
      if ((seed[static_cast<std::size_t>(v / 64)] >> (v % 64)) & 1)
        open.insert(v);
    while (!open.empty()) {
      const int v = *open.begin();
      open.erase(open.begin());
      if (!reached.insert(v).second)
        continue;
      const int x = v & 7, y = (v >> 3) & 7, z = v >> 6;
      for (const auto& [nx, ny, nz] : std::vector<std::array<int, 3>>{{x - 1, y, z},
                                                                      {x + 1, y, z},
                                                                      {x, y - 1, z},
                                                                      {x, y + 1, z},
                                                                      {x, y, z - 1},
                                                                      {x, y, z + 1}})
        if (nx >= 0 && nx < 8 && ny >= 0 && ny < 8 && nz >= 0 && nz < 8 &&
            ((room[static_cast<std::size_t>(nz)] >> (nx + 8 * ny)) & 1))
          open.insert(nx + 8 * ny + 64 * nz);
    }
    const BrickMask grown = grow(seed, room);
    for (int v = 0; v < 512; ++v)
      ASSERT_EQ(reached.contains(v),
                ((grown[static_cast<std::size_t>(v / 64)] >> (v % 64)) & 1) != 0);
  }
}

TEST(BrickBits, FacesOfNeighboursUseEqualMasks) {
  for (int axis = 0; axis < 3; ++axis)
    for (int a = 0; a < 8; ++a)
      for (int b = 0; b < 8; ++b) {
        const auto one = [&](int depth) {
          std::array<int, 3> at{};
          at[static_cast<std::size_t>(axis)] = depth;
          at[static_cast<std::size_t>((axis + 1) % 3)] = a;
          at[static_cast<std::size_t>((axis + 2) % 3)] = b;
          BrickMask m{};
          m[static_cast<std::size_t>(at[2])] = std::uint64_t{1} << (at[0] + 8 * at[1]);
          return m;
        };
        EXPECT_EQ(face(one(7), axis, 1), face(one(0), axis, 0));
        EXPECT_NE(face(one(7), axis, 1), 0U);
        EXPECT_EQ(face(one(6), axis, 1), 0U);
        EXPECT_EQ(face(one(1), axis, 0), 0U);
      }
}

}  // namespace
}  // namespace voxtouch::voxmap
