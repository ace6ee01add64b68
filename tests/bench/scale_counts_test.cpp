// Cost of a frame and a map as the scene grows: points tested, spheres visited, bytes; no clock.
// Triangles to 1e6 and grids to 1024^3 here, larger ones in scale_bench.
#include <gtest/gtest.h>

#include <cstdio>

#include "core/contact/contact_query.hpp"
#include "core/contact/instructions.hpp"
#include "core/voxmap/distance_field.hpp"
#include "core/voxmap/voxelise.hpp"
#include "tests/bench/bench_mesh.hpp"
#include "tests/bench/scale_scene.hpp"

namespace voxtouch::bench::scale_counts {
namespace {

constexpr std::size_t kPoints = 10'000;
constexpr Place kPlaces[] = {Place::kNear, Place::kLight, Place::kHeavy};

voxmap::Voxmap map_of(std::size_t triangles, int resolution) {
  return voxmap::voxelise(cup_mesh(triangles), grid_of(resolution), serial_for());
}

double bytes_a_voxel(const voxmap::Voxmap& map) {
  return static_cast<double>(map.bytes()) / static_cast<double>(map.surface_count());
}

void print(const char* what, double size, Place place, const FrameCounts& counts) {
  std::printf("%s %g, %s: %.0f tested, %.0f hit, %.1f groups of spheres\n", what, size,
              name_of(place).c_str(), counts.tested, counts.not_free, counts.looked_at);
}

/// A frame's points, and the groups of spheres in points. One leaf more or less is no growth.
double cost(const FrameCounts& counts) { return counts.tested + 2.0 * counts.looked_at + 8.0; }

TEST(Scale, FrameCostDoesNotDependOnTriangleCount) {
  double least[3], least_bytes = 0.0;
  for (const std::size_t triangles :
       {std::size_t{10'000}, std::size_t{1'000}, std::size_t{100'000}, std::size_t{1'000'000}}) {
    const voxmap::Voxmap map = map_of(triangles, 256);
    if (triangles == 10'000)
      least_bytes = bytes_a_voxel(map);
    std::printf("%zu triangles: %.2f bytes a surface voxel\n", triangles, bytes_a_voxel(map));
    EXPECT_NEAR(bytes_a_voxel(map) / least_bytes, 1.0, 0.15) << triangles;
    for (std::size_t n = 0; n < 3; ++n) {
      const FrameCounts counts = frame_counts(map, kPlaces[n], kPoints);
      print("triangles", static_cast<double>(triangles), kPlaces[n], counts);
      if (triangles == 10'000)
        least[n] = cost(counts);
      EXPECT_LE(cost(counts), 1.15 * least[n]) << triangles << ' ' << name_of(kPlaces[n]);
    }
  }
}

TEST(Scale, CostStaysFlatAndMemoryScalesWithTheSurface) {
  double at_256[3] = {}, bytes_at_256 = 0.0;
  for (const int resolution : {256, 128, 512, 1024}) {
    const voxmap::Voxmap map = map_of(10'000, resolution);
    if (resolution == 256)
      bytes_at_256 = bytes_a_voxel(map);
    const double table =
        static_cast<double>(map.table_bytes()) / static_cast<double>(map.surface_count());
    std::printf("%d^3: %zu surface voxels, %.2f bytes each, %.2f of them table\n", resolution,
                map.surface_count(), bytes_a_voxel(map), table);
    EXPECT_LE(bytes_a_voxel(map), 1.4 * bytes_at_256) << resolution;
    EXPECT_LE(table, 0.5) << resolution;
    // Without the table of small maps, which has a fixed limit: blocks and pages grow as the
    // surface.
    if (map.arrays().table == nullptr) {
      EXPECT_LE(table, 0.2) << resolution;
    }
    for (std::size_t n = 0; n < 3; ++n) {
      const FrameCounts counts = frame_counts(map, kPlaces[n], kPoints);
      print("resolution", resolution, kPlaces[n], counts);
      if (resolution == 256)
        at_256[n] = cost(counts);
      // A coarser grid resolves less. At kNear almost nothing is tested, and 1 % of the points is
      // the tolerance.
      EXPECT_LE(cost(counts), kPlaces[n] == Place::kNear
                                  ? 0.01 * kPoints
                                  : (resolution < 256 ? 1.5 : 1.1) * at_256[n])
          << resolution << ' ' << name_of(kPlaces[n]);
    }
  }
}

/// Bricks are near the surface only: bytes per surface voxel do not depend on the volume.
TEST(Scale, DistancesGrowAsTheSurface) {
  for (const auto& [resolution, most] : {std::pair{128, 60.0}, {256, 70.0}, {512, 90.0}}) {
    const voxmap::Voxmap map = map_of(10'000, resolution);
    const voxmap::DistanceField field =
        voxmap::build_distance_field(cup_mesh(10'000), map, {}, serial_for());
    const double bytes =
        static_cast<double>(field.bytes()) / static_cast<double>(map.surface_count());
    std::printf("%d^3: distances take %.1f bytes a surface voxel\n", resolution, bytes);
    EXPECT_LE(bytes, most) << resolution;
  }
}

/// With free distances of larger cells, every kernel agrees with doubles for every point.
TEST(Scale, HitsInALargeTableEqualBruteForce) {
  const voxmap::Voxmap map = map_of(1'000, 1024);
  ASSERT_GT(map.arrays().free_shift, voxmap::free_distance::kMinShift);
  ASSERT_EQ(map.arrays().table, nullptr) << "bricks are found by pages";
  for (const Place place : kPlaces) {
    const contact::ContactQuery query(map, tool(place, kPoints));
    const pointshell::Pointshell& shell = query.shell();
    contact::HitList hits;
    hits.reserve(kPoints);
    for (const Pose& pose : eight_poses(place)) {
      std::size_t surface = 0, interior = 0;
      const Vec3 local = pose.position - map.grid().origin;
      const Mat3 rotation = pose.orientation.normalized().toRotationMatrix();
      for (std::size_t p = 0; p < shell.size(); ++p) {
        const voxmap::VoxelKind kind =
            map.at(voxmap::Grid::voxel_of((rotation * shell.point(p) + local) / map.grid().edge));
        surface += kind == voxmap::VoxelKind::kSurface,
            interior += kind == voxmap::VoxelKind::kInterior;
      }
      double tested = -1.0;
      for (const auto kind : {contact::Instructions::kAny, contact::Instructions::kAvx2,
                              contact::Instructions::kAvx512}) {
        if (kind > contact::widest_instructions())
          continue;
        contact::use_instructions(kind);
        query.find(pose, hits);
        EXPECT_EQ(hits.surface.size(), surface);
        EXPECT_EQ(hits.interior.size(), interior);
        if (tested < 0.0)
          tested = hits.tested;
        EXPECT_EQ(hits.tested, tested) << "each kernel culls alike";
      }
      contact::use_instructions(contact::widest_instructions());
    }
  }
}

}  // namespace
}  // namespace voxtouch::bench::scale_counts
