#include <gtest/gtest.h>

#include <bit>
#include <set>

#include "core/pointshell/build_shell.hpp"
#include "core/voxmap/voxelise.hpp"
#include "tests/unit/voxmap/vectors.hpp"

namespace voxtouch::pointshell {
namespace {

using namespace test;

bool same_bits(const std::vector<ShellPoint>& a, const std::vector<ShellPoint>& b) {
  return std::equal(
      a.begin(), a.end(), b.begin(), b.end(), [](const ShellPoint& p, const ShellPoint& q) {
        return p.voxel == q.voxel && p.triangle == q.triangle && p.point == q.point &&
               p.normal == q.normal && p.plain_normal == q.plain_normal &&
               p.distance_m == q.distance_m && p.area_m2 == q.area_m2 &&
               p.coherence == q.coherence && p.open == q.open && p.tie == q.tie && p.rule == q.rule;
      });
}

double mesh_area(const mesh::TriangleMesh& mesh) {
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    sum +=
        0.5 *
        (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0)).norm();
  return sum;
}

void expect_sane(const std::vector<ShellPoint>& points, const voxmap::Grid& grid) {
  for (const ShellPoint& p : points) {
    ASSERT_NEAR(p.normal.norm(), 1.0, 1e-12);
    ASSERT_NEAR(p.plain_normal.norm(), p.plain_cancels ? 0.0 : 1.0, 1e-12);
    ASSERT_TRUE(p.point.allFinite());
    const Vec3 centre(p.voxel.i + 0.5, p.voxel.j + 0.5, p.voxel.k + 0.5);
    ASSERT_LE((grid.to_grid(p.point) - centre).cwiseAbs().maxCoeff(), 0.5 + 1e-12);
    ASSERT_GE(p.area_m2, 0.0);
    ASSERT_GE(p.coherence, 0.0);
    ASSERT_LE(p.coherence, 1.0 + 1e-12);
  }
}

TEST(ShellPoints, LieInTheSurfaceVoxelsOfTheVoxmap) {
  for (const std::string& name : vector_meshes()) {
    const voxmap::Grid grid = vector_grid(name);
    const auto points = shell_points(read_obj(name), grid, serial_for());
    std::vector<voxmap::VoxelIndex> voxels;
    for (const ShellPoint& p : points)
      voxels.push_back(p.voxel);
    EXPECT_EQ(voxels, voxels_of(voxmap::voxelise(read_obj(name), grid, serial_for()),
                                voxmap::VoxelKind::kSurface))
        << name;
    expect_sane(points, grid);
  }
}

TEST(ShellPoints, WeightsSumToTheAreaAlsoOnTheGrid) {
  for (const std::string& name : vector_meshes()) {
    const mesh::TriangleMesh mesh = read_obj(name);
    double sum = 0.0;
    for (const ShellPoint& p : shell_points(mesh, vector_grid(name), serial_for()))
      sum += p.area_m2;
    EXPECT_NEAR(sum / mesh_area(mesh), 1.0, 1e-11) << name;
  }
}

TEST(ShellPoints, AreBitIdenticalForAnyLoop) {
  const mesh::TriangleMesh mesh = sphere(Vec3(0.1, 0.2, 0.3), 1.0, 30);
  const voxmap::Grid grid = voxmap::default_grid(mesh, 0.037);
  EXPECT_TRUE(
      same_bits(shell_points(mesh, grid, serial_for()), shell_points(mesh, grid, scrambled_for())));
}

TEST(ShellPoints, ScaleByPowersOfTwoExactly) {
  const mesh::TriangleMesh mesh = read_obj("lshape");
  const voxmap::Grid grid = vector_grid("lshape");
  const auto at_one = shell_points(mesh, grid, serial_for());
  for (const double scale : {0x1p-20, 0x1p20}) {
    auto scaled = shell_points(moved(mesh, Vec3::Zero(), scale),
                               {grid.origin * scale, grid.edge * scale}, serial_for());
    for (ShellPoint& p : scaled)
      p.point /= scale, p.distance_m /= scale, p.area_m2 /= scale * scale;
    EXPECT_TRUE(same_bits(scaled, at_one));
  }
}

TEST(ShellPoints, AFarPoseMovesThePointsAndNothingElse) {
  const Vec3 far(1e6, -1e6, 1e6);
  const mesh::TriangleMesh mesh = read_obj("sphere");
  const voxmap::Grid grid = vector_grid("sphere");
  const auto near_points = shell_points(mesh, grid, serial_for());
  const auto far_points =
      shell_points(moved(mesh, far), {grid.origin + far, grid.edge}, serial_for());
  ASSERT_EQ(near_points.size(), far_points.size());
  for (std::size_t n = 0; n < near_points.size(); ++n) {
    ASSERT_EQ(near_points[n].voxel, far_points[n].voxel);
    ASSERT_EQ(near_points[n].normal, far_points[n].normal);
    ASSERT_LT((near_points[n].point + far - far_points[n].point).norm(), 1e-9);
  }
}

TEST(ShellPoints, LitterOnTheSurfaceChangesNothing) {
  for (const std::string& name : vector_meshes()) {
    const voxmap::Grid grid = vector_grid(name);
    const auto clean = shell_points(read_obj(name), grid, serial_for());
    const auto dirty = shell_points(littered(read_obj(name), 5), grid, serial_for());
    expect_sane(dirty, grid);
    ASSERT_EQ(clean.size(), dirty.size()) << name;
    for (std::size_t n = 0; n < clean.size(); ++n) {
      ASSERT_EQ(clean[n].voxel, dirty[n].voxel);
      ASSERT_NEAR(clean[n].distance_m, dirty[n].distance_m, 1e-12);
      ASSERT_EQ(clean[n].area_m2, dirty[n].area_m2);
      if (clean[n].tie)
        continue;
      ASSERT_LT((clean[n].point - dirty[n].point).norm(), 1e-9) << name << ' ' << n;
      ASSERT_LT((clean[n].normal - dirty[n].normal).norm(), 1e-9) << name << ' ' << n;
    }
  }
}

TEST(ShellPoints, HaveUnitNormalsForCancellingNormals) {
  // A sheet with two sides a tenth of a voxel apart, a cone's tip, a segment alone, a cube's
  // corners.
  const mesh::TriangleMesh plate = box(Vec3(0, 0, 0.42), Vec3(3, 3, 0.52));
  const voxmap::Grid grid{Vec3::Constant(-1.01), 1.0};
  const auto points = shell_points(plate, grid, serial_for());
  expect_sane(points, grid);
  std::size_t cancelling = 0;
  for (const ShellPoint& p : points)
    cancelling += p.rule == NormalRule::kFaceForCancelling;
  EXPECT_GT(cancelling, 0U);
  mesh::TriangleMesh cone;
  cone.vertices.push_back(Vec3(0.5, 0.5, 30));
  for (int n = 0; n < 16; ++n)
    cone.vertices.push_back(
        Vec3(0.5 + std::cos(n * 0.3926990817), 0.5 + std::sin(n * 0.3926990817), 0));
  for (std::uint32_t n = 0; n < 16; ++n)
    cone.triangles.push_back({0, 1 + n, 1 + (n + 1) % 16});
  expect_sane(shell_points(cone, grid, serial_for()), grid);
  mesh::TriangleMesh segment;
  segment.vertices = {Vec3(0.1, 0.1, 0.1), Vec3(2.3, 0.7, 1.9), Vec3(0.1, 0.1, 0.1),
                      Vec3(0.49, 0.49, 0.49)};
  segment.triangles = {{0, 1, 2}, {3, 3, 3}};
  expect_sane(shell_points(segment, grid, serial_for()), grid);
}

TEST(ShellPoints, SliversGiveNumbers) {
  mesh::TriangleMesh mesh = read_obj("lshape");
  std::mt19937 random(9);
  for (int n = 0; n < 300; ++n) {
    const auto t = mesh.triangles[random() % 20];
    const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]];
    const auto v = static_cast<std::uint32_t>(mesh.vertices.size());
    const double thin = std::ldexp(1.0, -10 - static_cast<int>(random() % 1000));
    mesh.vertices.insert(mesh.vertices.end(), {a, b, Vec3(0.5 * (a + b) + Vec3(thin, -thin, 0.0))});
    mesh.triangles.push_back({v, v + 1, v + 2});
  }
  const voxmap::Grid grid = voxmap::default_grid(mesh, 0.0625);
  expect_sane(shell_points(mesh, grid, serial_for()), grid);
}

TEST(Pointshell, IsInMortonOrderWithItsRanges) {
  const mesh::TriangleMesh mesh = read_obj("cylinder");
  const voxmap::Grid grid = vector_grid("cylinder");
  const auto points = shell_points(mesh, grid, serial_for());
  const Pointshell exact = make_exact_shell(shell_points(mesh, grid, serial_for()), grid);
  const Pointshell naive = make_naive_shell(shell_points(mesh, grid, scrambled_for()), grid);
  ASSERT_EQ(exact.size(), points.size());
  EXPECT_EQ(exact.id, naive.id);
  EXPECT_EQ(std::set<std::uint32_t>(exact.id.begin(), exact.id.end()).size(), points.size());
  voxmap::VoxelIndex low = points[0].voxel;
  for (const ShellPoint& p : points)
    low = {std::min(low.i, p.voxel.i), std::min(low.j, p.voxel.j), std::min(low.k, p.voxel.k)};
  std::uint64_t last = 0;
  for (std::size_t n = 0; n < exact.size(); ++n) {
    const ShellPoint& p = points[exact.id[n]];
    EXPECT_EQ(exact.point(n), p.point);
    EXPECT_EQ(exact.normal(n), p.normal);
    EXPECT_EQ(exact.area_m2[n], p.area_m2);
    EXPECT_EQ(exact.coherence[n], p.coherence);
    EXPECT_EQ(naive.point(n), grid.centre(p.voxel));
    EXPECT_EQ(naive.normal(n), p.normal);
    std::uint64_t key = 0;
    for (int bit = 0; bit < 10; ++bit)
      key |= (((p.voxel.i - low.i) >> bit) & 1ULL) << (3 * bit) |
             (((p.voxel.j - low.j) >> bit) & 1ULL) << (3 * bit + 1) |
             (((p.voxel.k - low.k) >> bit) & 1ULL) << (3 * bit + 2);
    EXPECT_TRUE(n == 0 || key > last);
    last = key;
  }
  EXPECT_EQ(exact.edge, grid.edge);
  double gap = 0.0;
  for (const ShellPoint& p : points)
    for (const ShellPoint& q : points)
      if (std::abs(p.voxel.i - q.voxel.i) + std::abs(p.voxel.j - q.voxel.j) +
              std::abs(p.voxel.k - q.voxel.k) ==
          1)
        gap = std::max(gap, (p.point - q.point).norm());
  EXPECT_EQ(largest_gap_m(points), gap);
}

TEST(Pointshell, RefusesImpossibleRequests) {
  const mesh::TriangleMesh mesh = box(Vec3::Zero(), Vec3::Constant(100.0));
  EXPECT_THROW(shell_points(mesh, voxmap::default_grid(mesh, 1e-3), serial_for()),
               voxmap::VoxelBudgetError);
  mesh::TriangleMesh bad = mesh;
  bad.vertices[2].y() = NAN;
  EXPECT_THROW(shell_points(bad, {}, serial_for()), std::runtime_error);
}

}  // namespace
}  // namespace voxtouch::pointshell
