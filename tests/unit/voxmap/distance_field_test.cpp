#include "core/voxmap/distance_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <random>
#include <thread>

#include "core/voxmap/closed_mesh.hpp"
#include "core/voxmap/distance_thickness.hpp"
#include "core/voxmap/voxelise.hpp"
#include "tests/unit/contact/field_scenes.hpp"

namespace voxtouch::test {
namespace distance_field_test {

constexpr double kEdge = 0.001;

double number(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
}
Quat turned(double angle) { return Quat(Eigen::AngleAxisd(angle, Vec3(1, 2, -1).normalized())); }

voxmap::FieldSample sample(const voxmap::DistanceField& field, const Vec3& x) {
  return field.at(field.grid().to_grid(x));
}

/// Signed distance of a box of that size about the origin.
double box_distance(const Vec3& size, const Vec3& x) {
  const Vec3 q = x.cwiseAbs() - 0.5 * size;
  return q.cwiseMax(0.0).norm() + std::min(0.0, q.maxCoeff());
}

/// Distance to all triangles: each triangle's nearest point as a convex combination of its corners,
/// found by trying every set of corners that may carry it.
double brute_distance(const mesh::TriangleMesh& mesh, const Vec3& x) {
  double best = HUGE_VAL;
  for (const auto& t : mesh.triangles) {
    const Vec3 corner[3] = {mesh.vertices[t[0]] - x, mesh.vertices[t[1]] - x,
                            mesh.vertices[t[2]] - x};
    for (int k = 0; k < 3; ++k) {
      const Vec3 &a = corner[k], &b = corner[(k + 1) % 3];
      best = std::min(best, a.norm());
      const double along = a.dot(a - b) / (a - b).squaredNorm();
      if (along > 0.0 && along < 1.0)
        best = std::min(best, (a + along * (b - a)).norm());
    }
    Mat3 equal;  // the foot f = sum w_i c_i has f . (c_1 - c_0) = f . (c_2 - c_0) = 0 and sum w_i =
                 // 1
    for (int k = 0; k < 3; ++k)
      equal.col(k) =
          Vec3(corner[k].dot(corner[1] - corner[0]), corner[k].dot(corner[2] - corner[0]), 1.0);
    const Vec3 weights = equal.inverse() * Vec3(0, 0, 1);
    if (weights.minCoeff() > 0.0)
      best = std::min(
          best, (weights[0] * corner[0] + weights[1] * corner[1] + weights[2] * corner[2]).norm());
  }
  return best;
}

TEST(DistanceField, IsTheDistanceToATiltedBox) {
  const Vec3 size(0.05, 0.04, 0.031);
  const Pose pose{Vec3(0.2, -0.1, 0.33), turned(0.5)};
  const Ground ground(box_mesh(size, pose), kEdge);
  std::mt19937_64 random(1);
  int inside = 0, outside = 0;
  for (int n = 0; n < 20000; ++n) {
    const Vec3 local(number(random, -0.03, 0.03), number(random, -0.03, 0.03),
                     number(random, -0.02, 0.02));
    const double truth = box_distance(size, local);
    const voxmap::FieldSample s = sample(ground.field, pose * local);
    if (truth > 2 * kEdge)
      continue;
    if (truth < -12 * kEdge) {
      EXPECT_LE(s.distance_m, -11.5 * kEdge);
      continue;
    }
    // Where the nearest face changes, the interpolation rounds the ridge off; otherwise it is exact
    // for planes.
    const Vec3 q = local.cwiseAbs() - 0.5 * size;
    Vec3 sorted = q;
    std::sort(sorted.data(), sorted.data() + 3);
    const bool one_face = sorted[2] - sorted[1] > 3 * kEdge && truth < 0.25 * kEdge &&
                          truth > -10.2 * kEdge;  // no node cut off
    ASSERT_NEAR(s.distance_m, truth, (one_face ? 1e-6 : 0.6) * kEdge) << local.transpose();
    if (one_face) {
      EXPECT_TRUE(s.known);
      EXPECT_FALSE(s.saturated);
      EXPECT_NEAR(s.gradient.norm(), 1.0, 1e-6);
    }
    ++(truth < 0 ? inside : outside);
  }
  EXPECT_GT(inside, 3000);
  EXPECT_GT(outside, 300);
}

TEST(DistanceField, NodesHoldTheDistanceToACurvedMesh) {
  const mesh::TriangleMesh mesh = sphere_mesh(0.009, 2);
  const Ground ground(mesh, kEdge);
  const voxmap::Grid& grid = ground.field.grid();
  std::mt19937_64 random(2);
  int compared = 0;
  for (int n = 0; n < 3000 && compared < 400; ++n) {
    const Vec3 u(std::floor(number(random, 1, 20)), std::floor(number(random, 1, 20)),
                 std::floor(number(random, 1, 20)));
    const voxmap::FieldSample s = ground.field.at(u);
    const Vec3 x = grid.from_grid(u);
    const double truth = brute_distance(mesh, x);
    if (truth > 1.99 * kEdge && x.norm() > 0.009)
      continue;
    ASSERT_NEAR(std::abs(s.distance_m), truth, 1e-6 * kEdge);
    if (truth > 0.3 * kEdge) {  // facets lie less than that below the sphere
      ASSERT_EQ(s.distance_m < 0, x.norm() < 0.009);
    }
    ++compared;
  }
  EXPECT_GE(compared, 400);
}

/// Contacts thus begin and end without a step: shell points in free voxels are never evaluated.
TEST(DistanceField, IsPositiveInFreeAndNegativeInInteriorVoxels) {
  std::mt19937_64 random(3);
  const mesh::TriangleMesh groove = joined(
      box_mesh(Vec3(0.02, 0.02, 0.008), {Vec3::Zero(), turned(0.7)}),
      box_mesh(Vec3(0.008, 0.02, 0.02), {turned(0.7) * Vec3(-0.008, 0, 0.006), turned(0.7)}));
  for (const mesh::TriangleMesh& mesh :
       {groove, sphere_mesh(0.012, 2), cylinder_mesh(0.006, 0.02, 7),
        inside_out(box_mesh(Vec3(0.015, 0.01, 0.012), {Vec3::Zero(), turned(0.4)}))}) {
    const Ground ground(mesh, kEdge);
    int free = 0, interior = 0;
    for (int n = 0; n < 60000; ++n) {
      const Vec3 u(number(random, 0, 34), number(random, 0, 34), number(random, 0, 34));
      const voxmap::VoxelKind kind = ground.voxmap.at(voxmap::Grid::voxel_of(u));
      const double distance = ground.field.at(u).distance_m;
      if (kind != voxmap::VoxelKind::kSurface) {
        ASSERT_EQ(distance < 0.0, kind == voxmap::VoxelKind::kInterior) << u.transpose();
        ASSERT_NE(distance, 0.0);
      }
      free += kind == voxmap::VoxelKind::kFree;
      interior += kind == voxmap::VoxelKind::kInterior;
    }
    EXPECT_GT(free, 1000);
    EXPECT_GT(interior, 500);
  }
}

/// A wall hardly thicker than a voxel has no interior voxel: the winding number decides instead of
/// the flood fill.
TEST(DistanceField, IsNegativeInAWallWithoutInteriorVoxels) {
  const Vec3 size(0.03, 0.03, 0.0014);
  const Pose pose{Vec3(0.1, 0.2, 0.3), turned(0.5)};
  const Ground ground(box_mesh(size, pose), kEdge);
  EXPECT_LT(ground.voxmap.interior_count(), 20U);
  const voxmap::Grid& grid = ground.field.grid();
  int inside = 0;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j)
      for (int k = 0; k < 40; ++k) {
        const Vec3 u(i, j, k);
        const double truth = box_distance(size, pose.inverse() * grid.from_grid(u));
        if (truth > 1.9 * kEdge)
          continue;
        ASSERT_NEAR(ground.field.at(u).distance_m, truth, 1e-6 * kEdge);
        inside += truth < -0.1 * kEdge;
      }
  EXPECT_GT(inside, 300);
}

TEST(DistanceField, HasTheSameSignsForEitherOrientation) {
  const mesh::TriangleMesh mesh = box_mesh(Vec3(0.02, 0.013, 0.009), {Vec3::Zero(), turned(0.3)});
  mesh::TriangleMesh mixed = mesh;
  std::swap(mixed.triangles[3][0], mixed.triangles[3][1]);
  std::swap(mixed.triangles[8][0], mixed.triangles[8][1]);
  const Ground right(mesh, kEdge), inverted(inside_out(mesh), kEdge), patched(mixed, kEdge);
  std::mt19937_64 random(4);
  for (int n = 0; n < 20000; ++n) {
    const Vec3 u(number(random, 0, 25), number(random, 0, 25), number(random, 0, 25));
    const double d = right.field.at(u).distance_m;
    ASSERT_EQ(inverted.field.at(u).distance_m, d);
    ASSERT_EQ(patched.field.at(u).distance_m, d);
  }
}

TEST(DistanceField, IsContinuousAcrossVoxelsBricksAndItsOwnBorders) {
  const Ground ground(box_mesh(Vec3(0.05, 0.045, 0.04), {Vec3(1.3, 0.2, -0.4), turned(0.4)}), kEdge,
                      5.0);
  std::mt19937_64 random(5);
  const double tiny = 1e-7;
  int bricks = 0, deep = 0, far = 0;
  for (int n = 0; n < 200000; ++n) {
    Vec3 u(number(random, -2, 75), number(random, -2, 75), number(random, -2, 75));
    const int axis = n % 3;
    u[axis] = std::round(u[axis]) +
              (n % 2 == 0 ? 0.0 : 8 * std::round(number(random, 0, 8)) - std::round(u[axis]));
    Vec3 before = u, after = u;
    before[axis] -= tiny, after[axis] += tiny;
    const voxmap::FieldSample a = ground.field.at(before), b = ground.field.at(after);
    ASSERT_LE(std::abs(a.distance_m - b.distance_m), 2.1 * tiny * std::sqrt(3.0) * kEdge)
        << u.transpose();
    bricks += std::fmod(u[axis], 8.0) == 0.0 && a.known;
    deep += a.saturated != b.saturated;
    far += a.known != b.known;
  }
  EXPECT_GT(bricks, 1000);
  EXPECT_GT(deep, 50);
  EXPECT_GT(far, 50);
}

TEST(DistanceField, SaturatesAtItsRangeAndRejectsInvalidPlaces) {
  const Ground ground(box_mesh(Vec3(0.06, 0.06, 0.06)), kEdge, 5.0);
  const voxmap::FieldSample deep = sample(ground.field, Vec3::Zero());
  EXPECT_TRUE(deep.known && deep.saturated);
  EXPECT_DOUBLE_EQ(deep.distance_m, -5 * kEdge);
  EXPECT_TRUE(deep.gradient.isZero(0.0));
  int shallow = 0, ended = 0;
  for (double depth = 0.0; depth < 0.030; depth += 0.00001) {
    const voxmap::FieldSample s = sample(ground.field, Vec3(0.030 - depth, 0.0003, 0.0002));
    EXPECT_NEAR(s.distance_m, -std::min(depth, 5 * kEdge), 0.6 * kEdge);
    const bool saturated = s.distance_m <= -5 * kEdge * (1 - 1e-9);
    if (saturated) {
      EXPECT_TRUE(s.saturated) << depth;
    }
    if (depth < 3.9 * kEdge) {
      EXPECT_FALSE(s.saturated) << depth;
    }
    shallow += !s.saturated, ended += saturated;
  }
  EXPECT_GT(shallow, 300);
  EXPECT_GT(ended, 1000);
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               inf = std::numeric_limits<double>::infinity();
  for (const Vec3& u :
       {Vec3(nan, 5, 5), Vec3(5, inf, 5), Vec3(5, 5, -inf), Vec3(1e300, 0, 0), Vec3(-1e9, 5, 5)}) {
    const voxmap::FieldSample s = ground.field.at(u);
    EXPECT_FALSE(s.known || s.saturated);
    EXPECT_DOUBLE_EQ(s.distance_m, 2 * kEdge);
  }
}

TEST(DistanceField, AnOpenMeshHasNoInsideAndDisturbsNone) {
  mesh::TriangleMesh open = box_mesh(Vec3(0.02, 0.02, 0.02));
  open.triangles.pop_back();
  const Ground nothing(open, kEdge);
  EXPECT_FALSE(nothing.field.has_inside());
  EXPECT_FALSE(sample(nothing.field, Vec3::Zero()).known);
  EXPECT_GT(sample(nothing.field, Vec3::Zero()).distance_m, 0.0);

  const mesh::TriangleMesh box = box_mesh(Vec3(0.04, 0.04, 0.04));
  mesh::TriangleMesh sheet;  // across the middle of the box
  sheet.vertices = {{-0.01, -0.01, 0.0003}, {0.01, -0.01, 0.0003}, {0, 0.01, 0.0003}};
  sheet.triangles = {{0, 1, 2}};
  const Ground with(joined(box, sheet), kEdge), without(box, kEdge);
  EXPECT_TRUE(with.field.has_inside());
  std::mt19937_64 random(6);
  for (int n = 0; n < 20000; ++n) {
    const Vec3 u(number(random, 0, 42), number(random, 0, 42), number(random, 0, 42));
    ASSERT_EQ(with.field.at(u).distance_m, without.field.at(u).distance_m) << u.transpose();
  }
}

TEST(DistanceField, OverlappingBodiesAreOne) {
  const Vec3 size(0.03, 0.02, 0.02);
  const Ground ground(joined(box_mesh(size), box_mesh(size, {Vec3(0.02, 0, 0), Quat::Identity()})),
                      kEdge);
  std::mt19937_64 random(7);
  for (int n = 0; n < 20000; ++n) {
    const Vec3 x(number(random, -0.017, 0.037), number(random, -0.012, 0.012),
                 number(random, -0.012, 0.012));
    const double truth =
        box_distance(Vec3(0.05, 0.02, 0.02), x - Vec3(0.01, 0, 0));  // of both together
    const double d = sample(ground.field, x).distance_m;
    if (std::abs(truth) > 1.8 * kEdge) {
      ASSERT_EQ(truth < 0, d <= 0) << x.transpose();
    }
    ASSERT_NEAR(std::min(d, 2 * kEdge), std::min(truth, 2 * kEdge), 0.6 * kEdge)
        << "the faces within are no surface";
  }
}

TEST(DistanceField, IsEqualForAnyNumberOfThreads) {
  const mesh::TriangleMesh mesh = sphere_mesh(0.02, 3);
  const voxmap::Grid grid = voxmap::default_grid(mesh, kEdge);
  const voxmap::Voxmap voxmap = voxmap::voxelise(mesh, grid, serial_for());
  const ParallelFor backwards = [](std::size_t count,
                                   const std::function<void(std::size_t)>& body) {
    for (std::size_t n = count; n-- > 0;)
      body(n);
  };
  const ParallelFor threads = [](std::size_t count, const std::function<void(std::size_t)>& body) {
    std::vector<std::thread> pool;
    for (std::size_t t = 0; t < 3; ++t)
      pool.emplace_back([&, t] {
        for (std::size_t n = t; n < count; n += 3)
          body(n);
      });
    for (std::thread& thread : pool)
      thread.join();
  };
  const voxmap::DistanceField one = voxmap::build_distance_field(mesh, voxmap, {}, serial_for()),
                              two = voxmap::build_distance_field(mesh, voxmap, {}, backwards),
                              three = voxmap::build_distance_field(mesh, voxmap, {}, threads);
  EXPECT_EQ(one.bytes(), two.bytes());
  EXPECT_EQ(one.steepest_gradient(), three.steepest_gradient());
  std::mt19937_64 random(8);
  for (int n = 0; n < 50000; ++n) {
    const Vec3 u(number(random, 0, 44), number(random, 0, 44), number(random, 0, 44));
    ASSERT_EQ(one.at(u).distance_m, two.at(u).distance_m);
    ASSERT_EQ(one.at(u).distance_m, three.at(u).distance_m);
  }
}

TEST(DistanceField, IsTheSameAMillionMetresAway) {
  // Multiples of 2^-20 m: exact at either place.
  const double e = 0x1p-10;
  mesh::TriangleMesh here = sphere_mesh(20 * e, 3);
  for (Vec3& v : here.vertices)
    v = (v * 0x1p20).array().round().matrix() * 0x1p-20;
  mesh::TriangleMesh there = here;
  const Vec3 offset(1e6, -1e6, 5e5);
  for (Vec3& v : there.vertices)
    v += offset;
  voxmap::Grid grid = voxmap::default_grid(here, e);
  const Ground a(here, grid, 12.0);
  grid.origin += offset;
  const Ground b(there, grid, 12.0);
  EXPECT_EQ(a.field.stored_nodes(), b.field.stored_nodes());
  std::mt19937_64 random(9);
  for (int n = 0; n < 50000; ++n) {
    const Vec3 u(number(random, 0, 44), number(random, 0, 44), number(random, 0, 44));
    ASSERT_EQ(a.field.at(u).distance_m, b.field.at(u).distance_m);
  }
}

/// Four bytes a node, 9^3 nodes for 8^3 voxels, in whole bricks round the surface layer. The
/// thinner the body, the more of its bricks is air.
TEST(DistanceField, HasItsStatedMemory) {
  struct Case {
    const char* name;
    mesh::TriangleMesh mesh;
    double bytes_a_voxel;  ///< at most, for each surface or interior voxel
  };
  for (const Case& c : {Case{"solid ball of 60 voxels", sphere_mesh(0.03, 4), 15.0},
                        Case{"plate of 5 voxels",
                             box_mesh(Vec3(0.1, 0.1, 0.005), {Vec3::Zero(), turned(0.4)}), 24.0},
                        Case{"plate of 2 voxels",
                             box_mesh(Vec3(0.1, 0.1, 0.002), {Vec3::Zero(), turned(0.4)}), 36.0}}) {
    const Ground ground(c.mesh, kEdge);
    const double voxels =
        static_cast<double>(ground.voxmap.surface_count() + ground.voxmap.interior_count());
    const double bytes = static_cast<double>(ground.field.bytes());
    std::printf("%s: %.3g voxels, %.4g bytes, %.2f a voxel, %.3f a node (voxmap %.2f a voxel)\n",
                c.name, voxels, bytes, bytes / voxels,
                bytes / static_cast<double>(ground.field.stored_nodes()),
                static_cast<double>(ground.voxmap.bytes()) / voxels);
    EXPECT_LE(bytes / voxels, c.bytes_a_voxel) << c.name;
    EXPECT_LE(bytes / static_cast<double>(ground.field.stored_nodes()), 4.2) << c.name;
  }
}

TEST(DistanceField, RefusesImpossibleSizes) {
  const mesh::TriangleMesh mesh = box_mesh(Vec3(0.02, 0.02, 0.02));
  const voxmap::Voxmap voxmap =
      voxmap::voxelise(mesh, voxmap::default_grid(mesh, kEdge), serial_for());
  for (const double bad : {1.0, -1.0, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(voxmap::build_distance_field(
                     mesh, voxmap, {.depth_voxels = bad, .band_voxels = 2.0}, serial_for()),
                 std::invalid_argument);
    EXPECT_THROW(voxmap::build_distance_field(
                     mesh, voxmap, {.depth_voxels = 12.0, .band_voxels = bad}, serial_for()),
                 std::invalid_argument);
  }
  EXPECT_THROW(voxmap::build_distance_field(mesh, voxmap, {}, serial_for(), 1000),
               voxmap::VoxelBudgetError);
}

TEST(ThinnestWall, IsFoundThroughTheSolidOnly) {
  const auto thinnest = [](const mesh::TriangleMesh& mesh) {
    const voxmap::Grid grid = voxmap::default_grid(mesh, kEdge);
    return voxmap::thinnest_wall(voxmap::ClosedMesh(mesh, grid), grid, serial_for()).thickness_m;
  };
  const Pose askew{Vec3(0.4, 0.3, 0.2), turned(0.8)};
  EXPECT_NEAR(thinnest(box_mesh(Vec3(0.05, 0.04, 0.007), askew)), 0.007, 1e-12);
  EXPECT_NEAR(thinnest(inside_out(box_mesh(Vec3(0.05, 0.04, 0.0001), askew))), 0.0001, 1e-12);
  EXPECT_NEAR(thinnest(sphere_mesh(0.02, 3)), 0.04, 0.0008);
  // A hollow ball: the cavity's wall faces inward.
  EXPECT_NEAR(thinnest(joined(sphere_mesh(0.02, 3), inside_out(sphere_mesh(0.017, 3)))), 0.003,
              0.0003);
  // Two thin plates that overlap are one thick one; the walls inside do not count.
  const mesh::TriangleMesh two =
      joined(box_mesh(Vec3(0.05, 0.05, 0.006)),
             box_mesh(Vec3(0.05, 0.05, 0.006), {Vec3(0, 0, 0.004), Quat::Identity()}));
  EXPECT_NEAR(thinnest(two), 0.010, 1e-12);
  const mesh::TriangleMesh thick = box_mesh(Vec3(0.05, 0.05, 0.03)),
                           thin = box_mesh(Vec3(0.05, 0.05, 0.002),
                                           {Vec3(0, 0, 0.1), Quat::Identity()});
  const mesh::TriangleMesh both = joined(thick, thin);
  const voxmap::Grid grid = voxmap::default_grid(both, kEdge);
  const voxmap::ThinnestWall wall =
      voxmap::thinnest_wall(voxmap::ClosedMesh(both, grid), grid, serial_for());
  EXPECT_NEAR(wall.thickness_m, 0.002, 1e-12);
  EXPECT_GE(wall.triangle, 12U);
  mesh::TriangleMesh open = box_mesh(Vec3(0.02, 0.02, 0.02));
  open.triangles.pop_back();
  EXPECT_TRUE(std::isinf(thinnest(open)));
}

}  // namespace distance_field_test
}  // namespace voxtouch::test
