#include "core/voxmap/object_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>

namespace voxtouch::voxmap {
namespace {

constexpr double kEdge = 2e-3;

void add_quad(mesh::TriangleMesh& mesh, const std::array<Vec3, 4>& corners) {
  const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
  mesh.triangles.insert(mesh.triangles.end(), {{n, n + 1, n + 2}, {n, n + 2, n + 3}});
}

/// A square of `side` across `axis`, `offset_voxels` along it.
void add_face(mesh::TriangleMesh& mesh, int axis, double offset_voxels, double side,
              double edge = kEdge) {
  std::array<Vec3, 4> corners;
  for (int n = 0; n < 4; ++n) {
    Vec3 at = Vec3::Zero();
    at[axis] = offset_voxels * edge;
    at[(axis + 1) % 3] = n == 1 || n == 2 ? side : 0.0;
    at[(axis + 2) % 3] = n >= 2 ? side : 0.0;
    corners[static_cast<std::size_t>(n)] = at;
  }
  add_quad(mesh, corners);
}

mesh::TriangleMesh faces(const std::vector<std::pair<double, double>>& offsets_and_sides,
                         int axis = 2) {
  mesh::TriangleMesh mesh;
  for (const auto& [offset, side] : offsets_and_sides)
    add_face(mesh, axis, offset, side);
  return mesh;
}

mesh::TriangleMesh box(const Vec3& low, const Vec3& high, const Quat& turn = Quat::Identity()) {
  mesh::TriangleMesh mesh;
  for (int n = 0; n < 8; ++n)
    mesh.vertices.push_back(turn * Vec3(n & 1 ? high.x() : low.x(), n & 2 ? high.y() : low.y(),
                                        n & 4 ? high.z() : low.z()));
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// How far a face at `offset_voxels` is from the nearest border [voxels].
double clearance(double offset_voxels, double fraction) {
  const double u = offset_voxels - fraction;
  return std::abs(u - std::round(u));
}

TEST(ObjectGrid, PutsTheFacesOfABlockOfWholeVoxelsIntoTheirMiddles) {
  EXPECT_EQ(clearance_of_faces(box({-0.12, -0.12, -0.02}, {0.12, 0.12, 0.0}), kEdge),
            Vec3::Constant(0.5));
  const Grid grid = object_grid(box({-0.12, -0.12, -0.02}, {0.12, 0.12, 0.0}), kEdge);
  EXPECT_EQ(grid.edge, kEdge);
  for (const double face : {-0.12, 0.12})
    EXPECT_NEAR(clearance((face - grid.origin.x()) / kEdge, 0.0), 0.5, 1e-12);
}

TEST(ObjectGrid, PutsAFaceAtAnyOffsetIntoTheMiddleOfItsVoxel) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double offset :
         {0.0, 1e-12, -1e-12, 0.125, 0.3, 0.5, 0.77, 0.999999, 1234.25, -17.6}) {
      SCOPED_TRACE(testing::Message() << "axis " << axis << ", offset " << offset);
      const Vec3 fraction = clearance_of_faces(faces({{offset, 0.1}}, axis), kEdge);
      for (int other = 0; other < 3; ++other)
        EXPECT_TRUE(other == axis || fraction[other] == 0.0);
      EXPECT_NEAR(clearance(offset, fraction[axis]), 0.5, 0.5 / 1024 + 1e-9);
      EXPECT_EQ(fraction[axis] * 1024, std::round(fraction[axis] * 1024));
      EXPECT_TRUE(fraction[axis] >= 0.0 && fraction[axis] < 1.0);
    }
}

TEST(ObjectGrid, KeepsTheDefaultOriginWithoutAlignedFaces) {
  const mesh::TriangleMesh tilted = box({-0.1, -0.1, -0.02}, {0.1, 0.1, 0.0},
                                        Quat(Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized())));
  EXPECT_EQ(clearance_of_faces(tilted, kEdge), Vec3::Zero());
  EXPECT_EQ(object_grid(tilted, kEdge).origin, default_grid(tilted, kEdge).origin);
  const mesh::TriangleMesh leaning =
      box({0, 0, 0}, {0.1, 0.1, 0.1}, Quat(Eigen::AngleAxisd(0.002, Vec3(1, 1, 1).normalized())));
  EXPECT_EQ(clearance_of_faces(leaning, kEdge), Vec3::Zero());
}

TEST(ObjectGrid, TakesAFaceThatLeansByRoundingForOneAlongTheGrid) {
  const mesh::TriangleMesh leaning =
      box({0, 0, 0}, {0.1, 0.1, 0.1}, Quat(Eigen::AngleAxisd(1e-7, Vec3(1, 1, 1).normalized())));
  EXPECT_EQ(clearance_of_faces(leaning, kEdge), Vec3::Constant(0.5));
}

TEST(ObjectGrid, LargerFacesWinAConflict) {
  EXPECT_EQ(clearance_of_faces(faces({{0.0, 1.0}, {0.25, 1.0}}), kEdge).z(), 0.625);
  EXPECT_EQ(clearance_of_faces(faces({{0.0, std::sqrt(3.0)}, {0.25, 1.0}}), kEdge).z(), 0.5625);
  EXPECT_EQ(clearance_of_faces(faces({{0.0, 1.0}, {0.25, std::sqrt(3.0)}}), kEdge).z(), 0.6875);
  EXPECT_EQ(clearance_of_faces(faces({{0.0, std::sqrt(3.0)}, {0.5, 1.0}}), kEdge).z(), 0.375)
      << "nor is the lesser one on a border";
  // Across the voxel's border the shorter distance counts.
  EXPECT_EQ(clearance_of_faces(faces({{0.9375, 1.0}, {7.0625, 1.0}}), kEdge).z(), 0.5);
}

TEST(ObjectGrid, TakesTheSmallerOffsetOfEquals) {
  EXPECT_EQ(clearance_of_faces(faces({{0.0, 1.0}, {0.5, 1.0}}), kEdge).z(), 0.25);
  EXPECT_EQ(clearance_of_faces(faces({{0.5, 1.0}, {3.0, 1.0}}), kEdge).z(), 0.25);
}

TEST(ObjectGrid, HasABorderInAnyWallOfHalfAVoxel) {
  for (int n = 0; n < 64; ++n) {
    const double low = n / 64.0;
    const double fraction =
        clearance_of_faces(box(kEdge * Vec3(0, 0, low), kEdge * Vec3(20, 20, low + 0.5)), kEdge)
            .z();
    EXPECT_EQ(std::ceil(low - fraction), low + 0.25 - fraction) << low;
    // One and a half: the border layers are a quarter full, and a voxel lies wholly in the wall.
    const double thick =
        clearance_of_faces(box(kEdge * Vec3(0, 0, low), kEdge * Vec3(20, 20, low + 1.5)), kEdge)
            .z();
    EXPECT_EQ(std::ceil(low - thick), low + 0.25 - thick) << low;
  }
}

TEST(ObjectGrid, FindsTheBestOffset) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> any(0.0, 1.0);
  for (int n = 0; n < 200; ++n) {
    std::vector<std::pair<double, double>> some;
    const int count = 1 + static_cast<int>(random() % 6);
    for (int k = 0; k < count; ++k)
      some.emplace_back(std::floor(1024 * 5 * any(random)) / 1024, 0.2 + any(random));
    const auto cost = [&](double fraction) {
      double sum = 0.0;
      for (const auto& [offset, side] : some)
        sum += side * side * std::pow(0.5 - clearance(offset, fraction), 2);
      return sum;
    };
    double least = 1e300, all = 0.0;
    for (int step = 0; step < 1024; ++step)
      least = std::min(least, cost(step / 1024.0));
    for (const auto& [offset, side] : some)
      all += side * side;
    EXPECT_LE(cost(clearance_of_faces(faces(some), kEdge).z()), least + 1e-6 * all) << n;
  }
}

TEST(ObjectGrid, DoesNotDependOnTriangleOrderOrCut) {
  std::mt19937_64 random(6);
  mesh::TriangleMesh mesh;
  for (int n = 0; n < 60; ++n)
    add_face(mesh, static_cast<int>(random() % 3), static_cast<double>(random() % 4096) / 128,
             0.01 + 1e-4 * static_cast<double>(random() % 100));
  const Vec3 fraction = clearance_of_faces(mesh, kEdge);
  for (int n = 0; n < 20; ++n) {
    std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
    EXPECT_EQ(clearance_of_faces(mesh, kEdge), fraction);
  }
  mesh::TriangleMesh cut = mesh;
  cut.triangles.clear();
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto middle = static_cast<std::uint32_t>(cut.vertices.size());
    cut.vertices.push_back((mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3.0);
    cut.triangles.insert(cut.triangles.end(), {{a, b, middle}, {b, c, middle}, {c, a, middle}});
  }
  EXPECT_EQ(clearance_of_faces(cut, kEdge), fraction);
}

TEST(ObjectGrid, ScalesAndMovesWithTheMesh) {
  const double e = 0x1p-9;
  mesh::TriangleMesh mesh = box({0.25 * e, 0.0, -3.0 * e}, {20.25 * e, 10.5 * e, 4.0 * e});
  const Grid here = object_grid(mesh, e);
  EXPECT_EQ(clearance_of_faces(mesh, e), Vec3(0.75, 0.25, 0.5));
  mesh::TriangleMesh large = mesh, far = mesh;
  for (Vec3& v : large.vertices)
    v *= 0x1p20;
  EXPECT_EQ(object_grid(large, e * 0x1p20).origin, 0x1p20 * here.origin);
  const Vec3 away = e * Vec3(1 << 28, -(1 << 27), 77);
  for (Vec3& v : far.vertices)
    v += away;
  EXPECT_EQ(object_grid(far, e).origin, here.origin + away);
}

TEST(ObjectGrid, LeavesOneToTwoLayersOfFreeVoxelsBeforeTheMesh) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> any(-3.0, 3.0);
  for (int n = 0; n < 100; ++n) {
    const Vec3 low(any(random), any(random), any(random)),
        size(3.0 + any(random), 4.0 + any(random), 5.0);
    const Grid grid = object_grid(box(kEdge * low, kEdge * (low + size)), kEdge);
    const Vec3 first = grid.to_grid(kEdge * low);
    EXPECT_GE(first.minCoeff(), 1.0 - 1e-9);
    EXPECT_LE(first.maxCoeff(), 3.0);
  }
}

TEST(ObjectGrid, RefusesInvalidMeshesAndBearsHugeNumbers) {
  EXPECT_THROW(object_grid({}, kEdge), std::runtime_error);
  mesh::TriangleMesh mesh = box({0, 0, 0}, {0.1, 0.1, 0.1});
  EXPECT_THROW(object_grid(mesh, 0.0), std::runtime_error);
  mesh.triangles.push_back({0, 1, 99});
  EXPECT_THROW(object_grid(mesh, kEdge), std::runtime_error);
  for (const double poison : {1e200, 1e307, -1e307, 5e-324}) {
    const mesh::TriangleMesh huge = box({0, 0, 0}, {1.0, poison, 0.1});
    const Vec3 fraction = clearance_of_faces(huge, kEdge);
    EXPECT_TRUE(fraction.allFinite()) << poison;
    EXPECT_TRUE(fraction.minCoeff() >= 0.0 && fraction.maxCoeff() < 1.0) << poison;
  }
}

TEST(ObjectGrid, ScansAMillionTrianglesInMilliseconds) {
  mesh::TriangleMesh mesh;
  constexpr std::uint32_t kSide = 708;
  for (std::uint32_t j = 0; j <= kSide; ++j)
    for (std::uint32_t i = 0; i <= kSide; ++i)
      mesh.vertices.emplace_back(1e-4 * i, 1e-4 * j, j < kSide / 2 ? 0.0 : 1e-4 * i);
  for (std::uint32_t j = 0; j < kSide; ++j)
    for (std::uint32_t i = 0; i < kSide; ++i) {
      const std::uint32_t a = j * (kSide + 1) + i, b = a + kSide + 1;
      mesh.triangles.insert(mesh.triangles.end(), {{a, a + 1, b + 1}, {a, b + 1, b}});
    }
  ASSERT_GT(mesh.triangles.size(), 1'000'000U);
  double best_ms = 1e9;
  for (int n = 0; n < 5; ++n) {
    const auto begin = std::chrono::steady_clock::now();
    ASSERT_EQ(clearance_of_faces(mesh, kEdge).z(), 0.5);
    best_ms = std::min(
        best_ms, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
                     .count());
  }
  std::printf("%zu triangles: %.1f ms\n", mesh.triangles.size(), best_ms);
  EXPECT_LT(best_ms, 200.0)
      << "a bound for slow builds on busy machines; measured is some milliseconds";
}

}  // namespace
}  // namespace voxtouch::voxmap
