#include "core/mesh/weld.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "samples.hpp"

using namespace voxtouch;

namespace {

TEST(Weld, MakesOneVertexOfEqualPositions) {
  const mesh::TriangleMesh loose = samples::soup(samples::box({0, 0, 0}, {1, 2, 3}));
  ASSERT_EQ(loose.vertices.size(), 36u);
  const mesh::TriangleMesh welded = mesh::weld(loose);
  EXPECT_EQ(welded.vertices.size(), 8u);
  for (std::size_t t = 0; t < 12; ++t) {
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(welded.corner(t, k), loose.corner(t, k)) << t;
  }
}

TEST(Weld, MakesOneVertexOfEqualPositionsWithoutATolerance) {
  EXPECT_EQ(mesh::weld(samples::soup(samples::tetrahedron()), 0.0).vertices.size(), 4u);
}

TEST(Weld, TakesZeroAndMinusZeroForEqual) {
  const mesh::TriangleMesh mesh{{{0.0, 1, 0}, {-0.0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
                                {{0, 2, 3}, {1, 3, 2}}};
  EXPECT_EQ(mesh::weld(mesh, 0.0).vertices.size(), 3u);
  EXPECT_EQ(mesh::weld(mesh).vertices.size(), 3u);
}

TEST(Weld, KeepsTheFirstVertexExactly) {
  const double step = 0x1p-23;
  const mesh::TriangleMesh mesh{{{1.0, 0, 0}, {1.0 + step, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                {{0, 2, 3}, {1, 3, 2}}};
  const mesh::TriangleMesh welded = mesh::weld(mesh);
  ASSERT_EQ(welded.vertices.size(), 3u);
  EXPECT_EQ(welded.vertices[0].x(), 1.0);
  EXPECT_EQ(welded.triangles[1], (std::array<std::uint32_t, 3>{0, 2, 1}));
}

TEST(Weld, ClosesASeamOfSingleStepsAndNothingWider) {
  for (const double scale : {1e-6, 1.0, 1e3}) {
    const auto vertices_with_gap = [&](double steps) {
      mesh::TriangleMesh mesh = samples::soup(samples::tetrahedron());
      for (Vec3& v : mesh.vertices)
        v *= scale;
      for (std::size_t v = 0; v < 3; ++v)
        mesh.vertices[v].array() += steps * 0x1p-24 * scale;
      return mesh::weld(mesh).vertices.size();
    };
    EXPECT_EQ(vertices_with_gap(1), 4u) << scale;
    EXPECT_EQ(vertices_with_gap(3), 4u) << scale;
    EXPECT_EQ(vertices_with_gap(20), 7u) << scale;
  }
}

TEST(Weld, FindsNeighboursAcrossEveryCellBorder) {
  // Pairs a little closer than the tolerance, everywhere: whatever the cells, some pairs straddle a
  // border.
  mesh::TriangleMesh mesh;
  mesh.vertices.emplace_back(1.0, 1.0, 1.0);
  for (int k = 0; k < 2000; ++k) {
    const double x = 0.000'37 * k + 1e-4;
    mesh.vertices.emplace_back(x, x, x);
    mesh.vertices.emplace_back(x + 0.9 * mesh::kWeldTolerance, x - 0.9 * mesh::kWeldTolerance,
                               x + 0.9 * mesh::kWeldTolerance);
  }
  for (std::uint32_t v = 0; v + 2 < mesh.vertices.size(); ++v)
    mesh.triangles.push_back({v, v + 1, v + 2});
  EXPECT_EQ(mesh::weld(mesh).vertices.size(), 2001u);
}

TEST(Weld, PrefersTheLowestNumberedOfSeveralNeighbours) {
  const double near = 0.8 * mesh::kWeldTolerance;
  const mesh::TriangleMesh mesh{{{1, 0, 0}, {1 + 2 * near, 0, 0}, {1 + near, 0, 0}, {0, 1, 0}},
                                {{0, 1, 3}, {1, 2, 3}}};
  const auto stands = mesh::standing_vertices(mesh, mesh::kWeldTolerance);
  EXPECT_EQ(stands, (std::vector<std::uint32_t>{0, 1, 0, 3}));
}

TEST(Weld, LeavesNonFiniteVerticesAlone) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               inf = std::numeric_limits<double>::infinity();
  const mesh::TriangleMesh mesh{{{nan, 0, 0}, {nan, 0, 0}, {inf, 0, 0}, {1, 0, 0}, {1, 0, 0}},
                                {{0, 1, 2}, {2, 3, 4}}};
  EXPECT_EQ(mesh::weld(mesh).vertices.size(), 4u);
}

TEST(Weld, IsNotMovedByAnUnusedVertexFarAway) {
  mesh::TriangleMesh mesh = samples::soup(samples::tetrahedron());
  for (std::size_t v = 0; v < 3; ++v)
    mesh.vertices[v].array() += 1e-4;
  mesh.vertices.emplace_back(1e30, 0, 0);
  EXPECT_EQ(mesh::weld(mesh).vertices.size(),
            8u);  // 4 + the corners of the shifted triangle + the unused one
}

TEST(Weld, RefusesATriangleWithoutItsVertex) {
  mesh::TriangleMesh mesh = samples::tetrahedron();
  mesh.triangles[2][1] = 4;
  EXPECT_THROW(mesh::weld(mesh), std::runtime_error);
  EXPECT_THROW(mesh::bounds(mesh), std::runtime_error);
}

TEST(Bounds, CoverUsedVerticesOnly) {
  mesh::TriangleMesh mesh = samples::tetrahedron();
  mesh.vertices.emplace_back(3, 3, 3);
  EXPECT_EQ(mesh::bounds(mesh).max(), Vec3(1, 1, 1));
  EXPECT_TRUE(mesh::bounds(mesh::TriangleMesh{{{1, 2, 3}}, {}}).isEmpty());
}

TEST(Transform, ScalesFirstThenPoses) {
  const Pose pose{{10, 0, 0}, Quat(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitZ()))};
  const mesh::TriangleMesh moved = mesh::transform(samples::tetrahedron(), 2.0, pose);
  EXPECT_LT((moved.vertices[1] - Vec3(10, 2, 0)).norm(), 1e-15);
  EXPECT_LT((moved.vertices[2] - Vec3(8, 0, 0)).norm(), 1e-15);
}

TEST(Transform, WithoutScaleAndPoseIsExact) {
  mesh::TriangleMesh mesh = samples::tetrahedron();
  mesh.vertices[1] = {0.1, 1.0 / 3.0, -7e-300};
  EXPECT_EQ(mesh::transform(mesh, 1.0, Pose{}).vertices, mesh.vertices);
}

}  // namespace
