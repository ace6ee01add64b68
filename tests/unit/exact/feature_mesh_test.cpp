#include "core/exact/feature_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/support/exact_shapes/shapes.hpp"

namespace voxtouch::exact {
namespace {

std::ptrdiff_t count(const FeatureMesh& mesh, EdgeKind kind) {
  return std::count_if(mesh.edges.begin(), mesh.edges.end(),
                       [&](const Edge& e) { return e.kind == kind; });
}

TEST(FeatureMesh, ABoxHasTwelveEdgesAndItsDiagonalsAreFlat) {
  const FeatureMesh box = find_features(test::box({-1, -1, -1}, {1, 1, 1}));
  EXPECT_EQ(count(box, EdgeKind::kConvex), 12);
  EXPECT_EQ(count(box, EdgeKind::kFlat), 6);
  EXPECT_EQ(box.row_edges.size(), 12u);
  EXPECT_EQ(box.row_vertices.size(), 8u);
  EXPECT_TRUE(box.parts.at(0).closed);
  EXPECT_DOUBLE_EQ(box.reach_m, std::sqrt(3.0));
}

TEST(FeatureMesh, AHoleHasConcaveEdgesInsideAndConvexRims) {
  const FeatureMesh block =
      find_features(test::block_with_hole(test::cross(0.01, 0.003, 0.0), 0.02, 0.0, 0.01));
  // Of the cross' twelve upright edges the eight outer ones are concave in the hole, the four inner
  // ones convex.
  const auto upright = [&](EdgeKind kind) {
    return std::count_if(block.edges.begin(), block.edges.end(), [&](const Edge& e) {
      const Vec3 along = block.points[e.ends[1]] - block.points[e.ends[0]];
      return e.kind == kind && along.head<2>().norm() < 1e-12 &&
             block.points[e.ends[0]].head<2>().norm() < 0.015;
    });
  };
  EXPECT_EQ(upright(EdgeKind::kConcave), 8);
  EXPECT_EQ(upright(EdgeKind::kConvex), 4);
  EXPECT_EQ(count(block, EdgeKind::kRim), 0);
}

TEST(FeatureMesh, ASheetHasRimsAndTwoSides) {
  const FeatureMesh sheet = find_features(test::sheet(1.0, 4));
  EXPECT_EQ(count(sheet, EdgeKind::kRim), 16);
  EXPECT_EQ(count(sheet, EdgeKind::kConvex) + count(sheet, EdgeKind::kConcave), 0);
  EXPECT_TRUE(std::all_of(sheet.faces.begin(), sheet.faces.end(),
                          [](const Face& f) { return f.two_sided; }));
  EXPECT_EQ(sheet.row_vertices.size(), 16u);
}

TEST(FeatureMesh, VerticesOfPlainFacesMakeNoRow) {
  const FeatureMesh sheet = find_features(test::sheet(1.0, 4));
  for (const std::uint32_t v : sheet.row_vertices)
    EXPECT_NEAR(sheet.points[v].head<2>().cwiseAbs().maxCoeff(), 0.5, 1e-12);
}

TEST(FeatureMesh, LeavesOutDoublesAndTrianglesWithoutArea) {
  mesh::TriangleMesh mesh = test::box({-1, -1, -1}, {1, 1, 1});
  const std::size_t sound = mesh.triangles.size();
  mesh.triangles.push_back(mesh.triangles[0]);
  mesh.triangles.push_back({mesh.triangles[1][1], mesh.triangles[1][0], mesh.triangles[1][2]});
  mesh.triangles.push_back({0, 0, 1});
  mesh.vertices.push_back(Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
  mesh.triangles.push_back({0, 1, static_cast<std::uint32_t>(mesh.vertices.size() - 1)});
  const FeatureMesh found = find_features(mesh);
  EXPECT_EQ(found.faces.size(), sound);
  EXPECT_TRUE(found.parts.at(0).closed);
  EXPECT_THROW(find_features({mesh.vertices, {{0, 0, 1}}}), std::runtime_error);
}

TEST(FeatureMesh, OppositeFacesHaveNoCommonEdge) {
  mesh::TriangleMesh mesh = test::sheet(1.0, 1);
  std::swap(mesh.triangles[1][0], mesh.triangles[1][1]);
  EXPECT_EQ(count(find_features(mesh), EdgeKind::kRim), 6);
}

}  // namespace
}  // namespace voxtouch::exact
