#include "core/mesh/report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/mesh/weld.hpp"
#include "samples.hpp"

using namespace voxtouch;
using samples::box;
using samples::flipped;
using samples::joined;
using samples::tetrahedron;

namespace {

/// One sentence per finding: number, and the first ones.
void expect_reports(const mesh::MeshReport& report, const std::string& count,
                    const std::string& places) {
  const auto all = report.sentences();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_TRUE(all[0].starts_with(count + " ") && all[0].contains(places)) << all[0];
}

using Indices = std::vector<std::uint32_t>;

TEST(MeshReport, IsEmptyForACleanMesh) {
  const mesh::MeshReport r = mesh::inspect(box({0, 0, 0}, {1, 2, 3}));
  EXPECT_TRUE(r.clean());
  EXPECT_TRUE(r.closed);
  EXPECT_FALSE(r.inverted);
  EXPECT_EQ(r.vertices, 8u);
  EXPECT_EQ(r.points, 8u);
  EXPECT_EQ(r.edges, 18u);
  EXPECT_EQ(r.triangles, 12u);
  EXPECT_EQ(r.parts, 1u);
  EXPECT_NEAR(r.signed_volume_m3, 6.0, 1e-12);
  EXPECT_EQ(r.max, Vec3(1, 2, 3));
}

TEST(MeshReport, MergesPerTriangleVertices) {
  const mesh::MeshReport r = mesh::inspect(samples::soup(tetrahedron()));
  EXPECT_TRUE(r.closed);
  EXPECT_EQ(r.vertices, 12u);
  EXPECT_EQ(r.points, 4u);
}

TEST(MeshReport, CountsOpenEdgesAndReportsNoInterior) {
  mesh::TriangleMesh mesh = tetrahedron();
  mesh.triangles.pop_back();
  const mesh::MeshReport r = mesh::inspect(mesh);
  EXPECT_FALSE(r.closed);
  EXPECT_EQ(r.open_edges.count, 3u);
  EXPECT_EQ(r.open_edges.examples, (Indices{0, 1, 2}));
  expect_reports(r, "3", " 0, 1, 2)");
}

TEST(MeshReport, NeverCallsAnOpenMeshInverted) {
  mesh::TriangleMesh mesh = flipped(tetrahedron());
  mesh.triangles.pop_back();
  EXPECT_FALSE(mesh::inspect(mesh).inverted);
}

TEST(MeshReport, FindsAMeshThatFacesInward) {
  const mesh::MeshReport r = mesh::inspect(flipped(tetrahedron()));
  EXPECT_TRUE(r.closed);
  EXPECT_TRUE(r.inverted);
  EXPECT_EQ(r.flipped.count, 0u);
  EXPECT_LT(r.signed_volume_m3, 0.0);
  EXPECT_EQ(r.sentences().size(), 1U);
}

TEST(MeshReport, NamesTheFlippedTriangleAndNotItsNeighbours) {
  for (std::uint32_t t = 0; t < 12; ++t) {
    mesh::TriangleMesh mesh = box({0, 0, 0}, {1, 1, 1});
    std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
    const mesh::MeshReport r = mesh::inspect(mesh);
    EXPECT_EQ(r.flipped.examples, Indices{t});
    EXPECT_EQ(r.flipped.count, 1u);
    EXPECT_TRUE(r.closed);
    EXPECT_TRUE(r.orientable);
  }
}

TEST(MeshReport, DistinguishesDuplicatesFromFlippedTriangles) {
  mesh::TriangleMesh mesh = tetrahedron();
  mesh.triangles.push_back({2, 1, 0});  // triangle 0, other first corner
  mesh.triangles.push_back({3, 2, 1});  // triangle 3, flipped
  const mesh::MeshReport r = mesh::inspect(mesh);
  EXPECT_EQ(r.duplicates.examples, Indices{4});
  EXPECT_EQ(r.opposite_duplicates.examples, Indices{5});
  EXPECT_TRUE(r.closed);
  EXPECT_EQ(r.non_manifold_edges.count, 0u);
  EXPECT_EQ(r.edges, 6u) << "of the sound triangles alone";
}

TEST(MeshReport, IgnoresZeroAreaTrianglesForClosedness) {
  mesh::TriangleMesh mesh = tetrahedron();
  mesh.vertices.emplace_back(0, 0, 0);    // same place as vertex 0
  mesh.vertices.emplace_back(0.5, 0, 0);  // on the edge 0-1
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back({0, 4, 2});
  mesh.triangles.push_back({0, 5, 1});
  const mesh::MeshReport r = mesh::inspect(mesh);
  EXPECT_EQ(r.zero_area.examples, (Indices{4, 5, 6}));
  EXPECT_TRUE(r.closed);
  EXPECT_EQ(r.triangles, 7u);
  EXPECT_EQ(r.edges, 6u) << "of the sound triangles alone";
}

TEST(MeshReport, ZeroAreaTriangleClosesALongEdge) {
  // The face on edge 0-1 of one side is split at vertex 4, the other is not; a collinear triangle
  // is between them.
  const mesh::TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5, 0, 0}},
                                {{0, 2, 4}, {4, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 1}}};
  const mesh::MeshReport r = mesh::inspect(mesh);
  EXPECT_EQ(r.zero_area.count, 1u);
  EXPECT_TRUE(r.closed);
  EXPECT_EQ(r.open_edges.count, 0u);
  mesh::TriangleMesh without = mesh;
  without.triangles.pop_back();
  EXPECT_EQ(mesh::inspect(without).open_edges.count, 3u);
}

TEST(MeshReport, FindsCollinearCornersAtAnyScaleAndPlace) {
  const Quat turn(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  for (const double scale : {1e-6, 1.0, 1e3}) {
    for (const double offset : {0.0, 1e6}) {
      mesh::TriangleMesh mesh{{{0, 0, 0}, {0.1, 0.2, 0.3}, {0.7, 1.4, 2.1}, {0, 1, 0}},
                              {{0, 1, 2}, {0, 1, 3}}};
      mesh = mesh::transform(mesh, scale, Pose{{offset, offset, -offset}, turn});
      const mesh::MeshReport r = mesh::inspect(mesh);
      EXPECT_EQ(r.zero_area.examples, Indices{0}) << scale << ' ' << offset;
    }
  }
}

TEST(MeshReport, FindsEdgesBetweenSheets) {
  // Two boxes with one common edge: four triangles there.
  const mesh::TriangleMesh mesh =
      mesh::weld(joined(box({0, 0, 0}, {1, 1, 1}), box({1, 1, 0}, {2, 2, 1})));
  const mesh::MeshReport r = mesh::inspect(mesh);
  EXPECT_EQ(r.non_manifold_edges.count, 1u);
  EXPECT_TRUE(r.closed);
  EXPECT_NEAR(r.signed_volume_m3, 2.0, 1e-12);
}

TEST(MeshReport, NamesPartsThatFaceInwardAmongOthers) {
  const mesh::TriangleMesh mesh =
      joined(box({0, 0, 0}, {3, 3, 3}), flipped(box({1, 1, 1}, {2, 2, 2})));
  const mesh::MeshReport r = mesh::inspect(mesh);
  EXPECT_EQ(r.parts, 2u);
  EXPECT_EQ(r.inward_parts.examples, Indices{12});
  EXPECT_FALSE(r.inverted);
  EXPECT_TRUE(r.closed);
  EXPECT_NEAR(r.signed_volume_m3, 26.0, 1e-12);
}

TEST(MeshReport, NamesANestedShellOfEqualOrientation) {
  const mesh::TriangleMesh mesh = joined(box({0, 0, 0}, {3, 3, 3}), box({1, 1, 1}, {2, 2, 2}));
  const mesh::MeshReport r = mesh::inspect(mesh);
  EXPECT_EQ(r.nested_parts.examples, Indices{12});
  expect_reports(r, "1", " 12)");
  // Also if the inner one comes first, and with a separate part next to it.
  const mesh::MeshReport first = mesh::inspect(joined(
      joined(box({1, 1, 1}, {2, 2, 2}), box({0, 0, 0}, {3, 3, 3})), box({7, 0, 0}, {8, 1, 1})));
  EXPECT_EQ(first.nested_parts.examples, Indices{0});
}

TEST(MeshReport, CavitiesAndNeighboursAreNotNested) {
  const mesh::TriangleMesh hollow =
      joined(box({0, 0, 0}, {9, 9, 9}), flipped(box({1, 1, 1}, {8, 8, 8})));
  const auto nested = [](const mesh::TriangleMesh& mesh) {
    return mesh::inspect(mesh).nested_parts.count;
  };
  EXPECT_EQ(nested(hollow), 0u);
  EXPECT_EQ(nested(joined(hollow, box({3, 3, 3}, {4, 4, 4}))), 0u)
      << "a rattle in a cavity is solid by itself";
  EXPECT_EQ(nested(joined(hollow, box({0.2, 0.2, 0.2}, {0.8, 0.8, 0.8}))), 1u) << "within the wall";
  EXPECT_EQ(nested(joined(box({0, 0, 0}, {3, 3, 3}), box({2, 1, 1}, {4, 2, 2}))), 0u) << "across";
  // In the notch of a U, within the box round it.
  const mesh::TriangleMesh u = joined(joined(box({0, 0, 0}, {1, 1, 5}), box({4, 0, 0}, {5, 1, 5})),
                                      box({1, 0, 0}, {4, 1, 1}));
  EXPECT_EQ(nested(joined(u, box({2, 0.2, 2}, {3, 0.8, 3}))), 0u);
}

TEST(MeshReport, ReportsThatAMoebiusStripHasOneSide) {
  mesh::TriangleMesh strip{{}, {{0, 1, 2}, {1, 3, 2}, {2, 3, 4}, {3, 5, 4}, {4, 5, 1}, {5, 0, 1}}};
  for (int k = 0; k < 3; ++k) {
    const double a = 2 * M_PI * k / 3;
    strip.vertices.emplace_back(std::cos(a), std::sin(a), 0.1 * k);
    strip.vertices.emplace_back(2 * std::cos(a + 0.1), 2 * std::sin(a + 0.1), 1.0);
  }
  EXPECT_FALSE(mesh::inspect(strip).orientable);
}

TEST(MeshReport, CountsNonFiniteAndUnusedVertices) {
  mesh::TriangleMesh mesh = tetrahedron();
  mesh.vertices.emplace_back(9, 9, 9);
  mesh.vertices[3].z() = std::numeric_limits<double>::quiet_NaN();
  const mesh::MeshReport r = mesh::inspect(mesh);
  EXPECT_EQ(r.not_finite_vertices.examples, Indices{3});
  EXPECT_EQ(r.unused_vertices.examples, Indices{4});
  EXPECT_FALSE(r.closed);
  EXPECT_EQ(r.max, Vec3(1, 1, 0));
  EXPECT_TRUE(std::isfinite(r.signed_volume_m3));
  EXPECT_EQ(r.edges, 3u) << "of the sound triangles alone";
}

TEST(MeshReport, ListsOnlyTheFirstFew) {
  mesh::TriangleMesh mesh = tetrahedron();
  for (int k = 0; k < 9; ++k)
    mesh.triangles.push_back({0, 0, 1});
  const mesh::MeshReport r = mesh::inspect(mesh);
  EXPECT_EQ(r.zero_area.count, 9u);
  EXPECT_EQ(r.zero_area.examples, (Indices{4, 5, 6, 7, 8}));
  expect_reports(r, "9", " 4, 5, 6, 7, 8, ...)");
}

TEST(MeshReport, SurvivesAnEmptyMesh) {
  const mesh::MeshReport r = mesh::inspect({});
  EXPECT_FALSE(r.closed);
  EXPECT_EQ(r.triangles, 0u);
}

TEST(MeshReport, KeepsTheVolumeFarFromTheOrigin) {
  const mesh::MeshReport r =
      mesh::inspect(mesh::transform(tetrahedron(), 1e-3, Pose{{1e3, -1e3, 1e3}, Quat::Identity()}));
  EXPECT_NEAR(r.signed_volume_m3 / (1e-9 / 6), 1.0, 1e-8);
}

}  // namespace
