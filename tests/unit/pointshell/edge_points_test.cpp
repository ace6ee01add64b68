// The points of sharp convex edges against the edges themselves.
#include "core/pointshell/edge_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/unit/contact/field_scenes.hpp"

namespace voxtouch::pointshell {
namespace {

constexpr double kEdge = 0.002;

Pointshell points_of(const mesh::TriangleMesh& mesh, const voxmap::Grid& grid) {
  return edge_points(voxmap::ClosedMesh(mesh, grid), grid);
}
Pointshell points_of(const mesh::TriangleMesh& mesh) {
  return points_of(mesh, voxmap::default_grid(mesh, kEdge));
}

/// Triangles that share no vertices, as STL files have them.
mesh::TriangleMesh torn(const mesh::TriangleMesh& mesh) {
  mesh::TriangleMesh out;
  for (const auto& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(out.vertices.size());
    for (const std::uint32_t v : t)
      out.vertices.push_back(mesh.vertices[v]);
    out.triangles.push_back({first, first + 1, first + 2});
  }
  return out;
}

TEST(EdgePoints, CoverTheEdgesAndCornersOfABlock) {
  const Vec3 half(0.02, 0.013, 0.0071);
  const Pose pose{Vec3(0.31, -0.02, 0.004),
                  Quat(Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()))};
  const mesh::TriangleMesh block = test::box_mesh(2 * half, pose);
  const voxmap::Grid grid = voxmap::default_grid(block, kEdge);
  for (const mesh::TriangleMesh& mesh : {block, test::inside_out(block), torn(block)}) {
    const Pointshell points = points_of(mesh, grid);
    std::vector<Vec3> own;
    for (std::size_t p = 0; p < points.size(); ++p) {
      const Vec3 at =
                     pose.orientation.conjugate() * (points.point(p) + grid.origin - pose.position),
                 off = (at.cwiseAbs() - half).cwiseAbs();
      EXPECT_LE((off.array() < 1e-12).count(), 3);
      ASSERT_GE((off.array() < 1e-12).count(), 2) << at.transpose();
      EXPECT_LE((at.cwiseAbs() - half).maxCoeff(), 1e-12);
      EXPECT_LT(points.normal(p).dot(pose.orientation * at), 0.0) << "a normal leads inward";
      EXPECT_NEAR(points.normal(p).norm(), 1.0, 1e-12);
      own.push_back(at);
    }
    const double kApart = kEdgePointsApart * kEdge * 1.0001;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 4; ++side)
        for (double fraction = -1.0; fraction <= 1.0; fraction += 0.01) {
          Vec3 at = half;
          at[(axis + 1) % 3] *= side & 1 ? 1.0 : -1.0, at[(axis + 2) % 3] *= side & 2 ? 1.0 : -1.0,
              at[axis] *= fraction;
          double nearest = std::numeric_limits<double>::infinity();
          for (const Vec3& p : own)
            nearest = std::min(nearest, (p - at).norm());
          ASSERT_LE(nearest, std::abs(fraction) == 1.0 ? 1e-12 : 0.5 * kApart);
        }
    EXPECT_LE(points.size(), static_cast<std::size_t>(8.0 * half.sum() / kApart) + 24);
  }
}

/// An L turned round its length, and a block with a hollow: none on the edge within, where shells'
/// points and distances are right by themselves.
TEST(EdgePoints, ExcludeConcaveEdges) {
  mesh::TriangleMesh prism;  // an L of 20 mm, its inner edge at (0, 0)
  const Vec3 outline[] = {{-0.01, -0.01, 0}, {0.01, -0.01, 0}, {0.01, 0, 0},
                          {0, 0, 0},         {0, 0.01, 0},     {-0.01, 0.01, 0}};
  for (const double z : {-0.01, 0.01})
    for (const Vec3& v : outline)
      prism.vertices.push_back(v + z * Vec3::UnitZ());
  for (std::uint32_t n = 0; n < 6; ++n) {
    const std::uint32_t m = (n + 1) % 6;
    prism.triangles.push_back({n, m, m + 6});
    prism.triangles.push_back({n, m + 6, n + 6});
  }
  for (const auto& t : {std::array<std::uint32_t, 3>{3, 0, 1}, {3, 1, 2}, {3, 4, 5}, {3, 5, 0}}) {
    prism.triangles.push_back({t[0], t[2], t[1]});
    prism.triangles.push_back({t[0] + 6, t[1] + 6, t[2] + 6});
  }
  const voxmap::Grid grid = voxmap::default_grid(prism, kEdge);
  const Pointshell points = points_of(prism, grid);
  EXPECT_GT(points.size(), 100U);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const Vec3 at = points.point(p) + grid.origin;
    EXPECT_TRUE(at.head<2>().norm() > 1e-3 || std::abs(at.z()) > 0.0099) << at.transpose();
  }
}

/// A cylinder's facets are 3.75 degrees apart.
TEST(EdgePoints, ExcludeFacetsOfRoundBodies) {
  const mesh::TriangleMesh cylinder = test::cylinder_mesh(0.02, 0.06, 96);
  const voxmap::Grid grid = voxmap::default_grid(cylinder, kEdge);
  const Pointshell points = points_of(cylinder, grid);
  EXPECT_GT(points.size(), 200U);
  for (std::size_t p = 0; p < points.size(); ++p)
    EXPECT_NEAR(std::abs((points.point(p) + grid.origin).z()), 0.03, 1e-12);
  EXPECT_EQ(points_of(test::sphere_mesh(0.02, 4)).size(), 0U);
}

/// Whether there is a point at a place in W, and its normal is along `inward`.
bool has(const Pointshell& points, const voxmap::Grid& grid, const Vec3& at, const Vec3& inward) {
  for (std::size_t p = 0; p < points.size(); ++p)
    if ((points.point(p) + grid.origin - at).norm() < 0.26 * kEdge &&
        points.normal(p).dot(inward.normalized()) > 0.999)
      return true;
  return false;
}

/// A block without its last triangle: the edges that it has still, of which two are rims now, and
/// the rim across the side.
TEST(EdgePoints, OfAnOpenMeshAreItsSharpEdgesAndItsRims) {
  mesh::TriangleMesh open = test::box_mesh(Vec3(0.02, 0.02, 0.02));
  const voxmap::Grid grid = voxmap::default_grid(open, kEdge);
  const std::size_t closed = points_of(open, grid).size();
  const std::array<std::uint32_t, 3> gone = open.triangles.back();
  open.triangles.pop_back();
  const Pointshell points = points_of(open, grid);
  EXPECT_GT(points.size(), closed + 20U);
  EXPECT_TRUE(has(points, grid, Vec3(0.01, 0.01, 0.0), Vec3(-1, -1, 0)) ||
              has(points, grid, Vec3(-0.01, 0.01, 0.0), Vec3(1, -1, 0)))
      << "a fold";
  const Vec3 &a = open.vertices[gone[0]], &b = open.vertices[gone[1]], &c = open.vertices[gone[2]];
  const Vec3 normal = (b - a).cross(c - a), inward = normal.dot(a) > 0.0 ? Vec3(-normal) : normal;
  for (const auto& [from, to, opposite] : {std::array{a, b, c}, {b, c, a}, {c, a, b}}) {
    const Vec3 middle = 0.5 * (from + to), along = (to - from).normalized();
    const bool across =
        along.cwiseAbs().maxCoeff() < 0.9;  // in the side; the two others end the sides next to it
    const Vec3 away = (opposite - middle).dot(along) * along - (opposite - middle);
    EXPECT_TRUE(has(points, grid, middle, across ? away : inward)) << middle.transpose();
  }
}

/// Where sheets stand on a sheet, and where one goes on flat, none stands out; where two triangles
/// are one, it has an end as a sheet has.
TEST(EdgePoints, OfSheetsLieOnRimsAndFolds) {
  const mesh::TriangleMesh sheet = test::plate_mesh(0.02, 0.0);
  const voxmap::Grid grid = voxmap::default_grid(sheet, kEdge);
  mesh::TriangleMesh doubled = sheet;
  for (const auto& t : sheet.triangles)
    doubled.triangles.push_back({t[0], t[2], t[1]});
  for (const mesh::TriangleMesh& mesh : {sheet, torn(sheet), doubled}) {
    const Pointshell points = points_of(mesh, grid);
    ASSERT_GT(points.size(), 70U);
    for (std::size_t p = 0; p < points.size(); ++p) {
      const Vec3 at = points.point(p) + grid.origin;
      ASSERT_NEAR(at.cwiseAbs().maxCoeff(), 0.01, 1e-12) << at.transpose();
      EXPECT_LT(points.normal(p).dot(at), 0.0) << at.transpose();
    }
    EXPECT_TRUE(has(points, grid, Vec3(0.01, 0.001, 0.0), Vec3(-1, 0, 0)));
  }
  mesh::TriangleMesh tee;  // three halves at the x axis
  tee.vertices = {{-0.01, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}, {0, -0.01, 0}, {0, 0, 0.01}};
  tee.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
  const voxmap::Grid other_grid = voxmap::default_grid(tee, kEdge);
  const Pointshell points = points_of(tee, other_grid);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const Vec3 at = points.point(p) + other_grid.origin;
    EXPECT_TRUE(at.tail<2>().norm() > 1e-6 || std::abs(at.x()) > 0.0099) << at.transpose();
  }
}

}  // namespace
}  // namespace voxtouch::pointshell
