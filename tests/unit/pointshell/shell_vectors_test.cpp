#include <gtest/gtest.h>

#include <cstdio>

#include "core/pointshell/build_shell.hpp"
#include "tests/unit/voxmap/vectors.hpp"

namespace voxtouch::pointshell {
namespace {

using namespace test;
using Row = std::map<std::string, double>;

Vec3 vec(const Row& row, const std::string& name) {
  return {row.at(name + "x"), row.at(name + "y"), row.at(name + "z")};
}

/// Largest differences over all rows; printed.
struct Largest {
  double point = 0.0, distance = 0.0, normal = 0.0, plain = 0.0, coherence = 0.0;
};

class ShellVectors : public testing::TestWithParam<std::string> {};

TEST_P(ShellVectors, EqualsTheReference) {
  const std::string name = GetParam();
  const voxmap::Grid grid = vector_grid(name);
  const std::vector<ShellPoint> points = shell_points(read_obj(name), grid, serial_for());
  std::ifstream file = open_vector("voxels/" + name + "_surface.csv");
  const std::vector<Row> rows = read_csv(file);
  ASSERT_EQ(points.size(), rows.size());
  Largest largest;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const ShellPoint& p = points[n];
    const Row& row = rows[n];
    SCOPED_TRACE(name + " row " + std::to_string(n));
    ASSERT_EQ(p.voxel, (voxmap::VoxelIndex{int(row.at("i")), int(row.at("j")), int(row.at("k"))}));
    EXPECT_EQ(p.open, row.at("open") != 0.0);
    EXPECT_EQ(p.tie, row.at("tie") != 0.0);
    largest.distance = std::max(largest.distance, std::abs(p.distance_m - row.at("dist")));
    EXPECT_NEAR(p.distance_m, row.at("dist"), 1e-9);
    EXPECT_NEAR((p.point - grid.centre(p.voxel)).norm(), row.at("dist"), 1e-9);
    EXPECT_NEAR(p.coherence, row.at("coh"), 0.51e-4);
    largest.coherence = std::max(largest.coherence, std::abs(p.coherence - row.at("coh")));
    largest.plain = std::max(largest.plain, (p.plain_normal - vec(row, "m")).norm());
    EXPECT_LT((p.plain_normal - vec(row, "m")).norm(), 2e-7);
    if (row.at("tie") != 0.0)
      continue;
    largest.point = std::max(largest.point, (p.point - vec(row, "p")).norm());
    EXPECT_LT((p.point - vec(row, "p")).norm(), 1e-9);
    EXPECT_EQ(p.triangle, static_cast<std::uint32_t>(row.at("tri")));
    EXPECT_EQ(static_cast<int>(p.rule), int(row.at("fallback")));
    largest.normal = std::max(largest.normal, (p.normal - vec(row, "n")).norm());
    EXPECT_LT((p.normal - vec(row, "n")).norm(), 1e-9);
  }
  std::printf("%s: point %.2g, dist %.2g, n %.2g, m %.2g, coh %.2g over %zu rows\n", name.c_str(),
              largest.point, largest.distance, largest.normal, largest.plain, largest.coherence,
              rows.size());
  const auto& said = vector_index().at("meshes").at(name).at("pointshell");
  double largest_centre_distance_m = 0.0;
  for (const ShellPoint& p : points)
    largest_centre_distance_m = std::max(largest_centre_distance_m, p.distance_m);
  EXPECT_NEAR(largest_gap_m(points) / grid.edge,
              said.at("max_gap_face_neighbours_in_e").get<double>(), 1e-9);
  EXPECT_NEAR(largest_centre_distance_m / grid.edge,
              said.at("max_centre_distance_in_e").get<double>(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(All, ShellVectors, testing::ValuesIn(vector_meshes()),
                         [](const auto& mesh) { return mesh.param; });

}  // namespace
}  // namespace voxtouch::pointshell
