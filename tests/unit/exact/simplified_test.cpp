/// Fewer triangles for the same surface.
#include "core/exact/simplified.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "core/exact/closest.hpp"
#include "core/exact/limits.hpp"
#include "core/mesh/report.hpp"
#include "core/mesh/weld.hpp"
#include "tests/unit/exact/rig.hpp"

namespace voxtouch::exact {
namespace {

constexpr SimplifyBounds kBounds{limits::kSimplifiedM, limits::kSimplifiedRad};

mesh::TriangleMesh simple(const mesh::TriangleMesh& mesh) {
  return simplify(mesh::weld(mesh), {}, kBounds).mesh;
}

double distance(const Vec3& point, const mesh::TriangleMesh& mesh) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const OnTriangle on =
        nearest_on_triangle(point, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
    least = std::min(least, (point - on.point).norm());
  }
  return least;
}

/// Largest distance of 15 points of each n-th triangle of `of` from `to`.
double largest_distance(const mesh::TriangleMesh& of, const mesh::TriangleMesh& to, std::size_t n) {
  double most = 0.0;
  for (std::size_t t = 0; t < of.triangles.size(); t += n)
    for (int i = 0; i <= 4; ++i)
      for (int j = 0; i + j <= 4; ++j)
        most = std::max(most,
                        distance(of.corner(t, 0) + 0.25 * i * (of.corner(t, 1) - of.corner(t, 0)) +
                                     0.25 * j * (of.corner(t, 2) - of.corner(t, 0)),
                                 to));
  return most;
}

TEST(Simplified, ASubdividedBlockHasTwelveTriangles) {
  const mesh::TriangleMesh box = test::box({-.01, -.02, -.03}, {.01, .02, .03});
  mesh::TriangleMesh fine = box;
  for (int level = 0; level < 3; ++level) {
    mesh::TriangleMesh finer;
    for (std::size_t t = 0; t < fine.triangles.size(); ++t) {
      const Vec3 a = fine.corner(t, 0), b = fine.corner(t, 1), c = fine.corner(t, 2);
      const Vec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
      for (const Vec3& v : {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca})
        finer.vertices.push_back(v);
      const auto n = static_cast<std::uint32_t>(finer.vertices.size()) - 12;
      for (std::uint32_t k = 0; k < 4; ++k)
        finer.triangles.push_back({n + 3 * k, n + 3 * k + 1, n + 3 * k + 2});
    }
    fine = mesh::weld(finer);
  }
  ASSERT_EQ(fine.triangles.size(), 768u);
  const mesh::TriangleMesh simplified = simple(fine);
  EXPECT_EQ(simplified.triangles.size(), 12u);
  EXPECT_EQ(simplified.vertices.size(), 8u);
  EXPECT_TRUE(mesh::inspect(simplified).closed);
  EXPECT_LT(largest_distance(simplified, box, 1), 1e-15);
}

TEST(Simplified, CurvedSurfacesStayWithinTheBound) {
  struct Case {
    const char* name;
    mesh::TriangleMesh mesh;
    double ratio;  ///< of triangles, at most
  };
  for (const Case& c : {Case{"ground", test::terrain(0.024, 60, 0.0001), 0.9},
                        Case{"thread", test::bolt(0.005, 32), 0.25},
                        Case{"cylinder", test::prism(test::circle(0.02, 1500), -0.01, 0.01), 0.4},
                        Case{"ball", test::ball(0.01, 4), 1.0}}) {
    SCOPED_TRACE(c.name);
    const mesh::TriangleMesh simplified = simple(c.mesh);
    EXPECT_LE(static_cast<double>(simplified.triangles.size()),
              c.ratio * static_cast<double>(c.mesh.triangles.size()));
    EXPECT_LT(largest_distance(simplified, c.mesh, 7), 1.2 * limits::kSimplifiedM);
    EXPECT_LT(largest_distance(c.mesh, simplified, 7), 1.2 * limits::kSimplifiedM);
    EXPECT_EQ(mesh::inspect(simplified).closed, mesh::inspect(c.mesh).closed);
    for (const Vec3& vertex : simplified.vertices)
      EXPECT_NE(std::find(c.mesh.vertices.begin(), c.mesh.vertices.end(), vertex),
                c.mesh.vertices.end());
  }
}

Vec3 normal_of(const mesh::TriangleMesh& mesh, std::size_t t) {
  return (mesh.corner(t, 1) - mesh.corner(t, 0))
      .cross(mesh.corner(t, 2) - mesh.corner(t, 0))
      .normalized();
}

TEST(Simplified, NormalsTurnByTheBoundAtMost) {
  const mesh::TriangleMesh ground = test::terrain(0.024, 60, 0.0001), simplified = simple(ground);
  for (std::size_t t = 0; t < ground.triangles.size(); t += 7) {
    const Vec3 middle = (ground.corner(t, 0) + ground.corner(t, 1)) / 2;
    double least = 1.0;
    for (std::size_t k = 0; k < simplified.triangles.size(); ++k) {
      const OnTriangle on = nearest_on_triangle(middle, simplified.corner(k, 0),
                                                simplified.corner(k, 1), simplified.corner(k, 2));
      if ((middle - on.point).norm() <= limits::kSimplifiedM)
        least = std::min(least, angle_between(normal_of(ground, t), normal_of(simplified, k)));
    }
    EXPECT_LE(least, 1.0001 * limits::kSimplifiedRad);
  }
}

TEST(Simplified, RimsAndBordersOfOwnersRemain) {
  const mesh::TriangleMesh sheet = test::sheet(0.04, 20);
  std::vector<std::uint32_t> owners;
  for (std::size_t t = 0; t < sheet.triangles.size(); ++t)
    owners.push_back((sheet.corner(t, 0) + sheet.corner(t, 1) + sheet.corner(t, 2)).x() > 0.0);
  const SimplifiedMesh out = simplify(mesh::weld(sheet), owners, kBounds);
  EXPECT_LT(out.mesh.triangles.size(), sheet.triangles.size() / 4);
  std::array<double, 2> area{};
  for (std::size_t t = 0; t < out.mesh.triangles.size(); ++t) {
    const Vec3 a = out.mesh.corner(t, 0), b = out.mesh.corner(t, 1), c = out.mesh.corner(t, 2);
    const std::uint32_t owner = owners[out.triangles[t]];
    EXPECT_EQ(owner, (a + b + c).x() > 0.0);
    area[owner] += 0.5 * (b - a).cross(c - a).norm();
  }
  EXPECT_NEAR(area[0], 0.5 * 0.04 * 0.04, 1e-12);
  EXPECT_NEAR(area[1], 0.5 * 0.04 * 0.04, 1e-12);
}

TEST(Simplified, TrianglesWithoutAnAreaRemainWithTheirOwners) {
  mesh::TriangleMesh mesh = test::box({-.01, -.01, -.01}, {.01, .01, .01});
  mesh.triangles.push_back({0, 0, 1});
  std::vector<std::uint32_t> owners(mesh.triangles.size(), 0);
  owners.back() = 1;
  const SimplifiedMesh out = simplify(mesh, owners, kBounds);
  EXPECT_EQ(out.mesh.triangles.size(), 13u);
  EXPECT_EQ(owners[out.triangles.back()], 1u);
}

TEST(Simplified, TrianglesWithoutAnAreaKeepTheirVertices) {
  mesh::TriangleMesh sheet = mesh::weld(test::sheet(0.04, 4));
  const std::size_t middle = 12;
  ASSERT_EQ(sheet.vertices[middle], Vec3::Zero());
  sheet.triangles.push_back({12, 12, 0});
  const SimplifiedMesh out = simplify(sheet, {}, kBounds);
  EXPECT_NE(std::find(out.mesh.vertices.begin(), out.mesh.vertices.end(), Vec3::Zero()),
            out.mesh.vertices.end());
}

TEST(Simplified, ThinSolidsKeepBothSides) {
  mesh::TriangleMesh flat;
  flat.vertices = {{0, 0, 0}, {.01, 0, 0}, {0, .01, 0}, {.003, .003, 2e-6}};
  flat.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  EXPECT_EQ(simple(flat).triangles.size(), 4u);

  mesh::TriangleMesh lens;
  lens.vertices = {{0, 0, 2e-6}, {0, 0, -2e-6}};
  for (const auto& p : test::circle(0.01, 8))
    lens.vertices.emplace_back(p.x(), p.y(), 0.0);
  for (std::uint32_t k = 0; k < 8; ++k) {
    lens.triangles.push_back({0, 2 + k, 2 + (k + 1) % 8});
    lens.triangles.push_back({1, 2 + (k + 1) % 8, 2 + k});
  }
  const mesh::TriangleMesh simplified = simple(lens);
  EXPECT_TRUE(mesh::inspect(simplified).closed);
  EXPECT_EQ(simplified.triangles.size(), 12u);  // flat, from either side
  std::set<std::set<std::uint32_t>> faces;
  for (const auto& t : simplified.triangles)
    EXPECT_TRUE(faces.insert({t.begin(), t.end()}).second);
}

TEST(Simplified, AVertexOfTwoSheetsRemains) {
  const mesh::TriangleMesh sheet = test::sheet(0.04, 4);
  const Pose askew{Vec3::Zero(), turned(0.5, Vec3::UnitZ())};
  const mesh::TriangleMesh both = mesh::weld(test::joined(sheet, test::moved(sheet, askew)));
  const mesh::TriangleMesh out = simplify(both, {}, kBounds).mesh;
  double area = 0.0;
  for (std::size_t t = 0; t < out.triangles.size(); ++t)
    area += 0.5 *
            (out.corner(t, 1) - out.corner(t, 0)).cross(out.corner(t, 2) - out.corner(t, 0)).norm();
  EXPECT_NEAR(area, 2 * 0.04 * 0.04, 1e-12);
}

/// Of a part with thousands of small triangles that touch at once.
TEST(Simplified, ANutRestsOnItsBoltsFlanks) {
  const double gap = 2.5e-4, play = gap * std::tan(30.0 * kDegree);
  Rig rig(simple(test::nut(0.01, gap, 32)), simple(test::bolt(0.02, 32)));
  ASSERT_TRUE(rig.virtual_tool.place({}, {&rig.object_pose, 1}));
  rig.lead({}, {Vec3(0, 0, -1e-3), Quat::Identity()}, 100);
  const VirtualToolFrame frame = rig.rest({Vec3(0, 0, -1e-3), Quat::Identity()}, 50);
  EXPECT_FALSE(frame.not_converged);
  EXPECT_NEAR(frame.tool.position.z(), -play, 1e-5);
  EXPECT_GT(frame.wrench(1000.0).force.z(), 0.8);
  EXPECT_FALSE(rig.intersects());
}

}  // namespace
}  // namespace voxtouch::exact
