// The distances of a brick, many nodes at once, are bit-identical to those of each node from the
// tree.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <random>

#include "core/voxmap/brick_distances.hpp"
#include "core/voxmap/brick_range.hpp"
#include "tests/support/seed.hpp"

namespace voxtouch::test::brick_distances {
namespace {

using voxmap::DistanceTree;

struct Soup {
  mesh::TriangleMesh mesh;
  std::vector<std::uint32_t> all;

  /// Triangles of about `size` voxels in a cube of 40; each tenth a line, each eleventh a point,
  /// some on the grid.
  Soup(std::mt19937_64& random, std::size_t count, double size) : all(count) {
    std::uniform_real_distribution<double> place(-10.0, 30.0), step(-size, size);
    for (std::uint32_t t = 0; t < count; ++t) {
      Vec3 a(place(random), place(random), place(random));
      if (t % 7 == 0)
        a = a.array().round();
      Vec3 b = a + Vec3(step(random), step(random), step(random)),
           c = a + Vec3(step(random), step(random), step(random));
      if (t % 5 == 0)
        b.z() = c.z() = a.z();
      if (t % 10 == 0)
        c = a + 0.5 * (b - a);
      if (t % 11 == 0)
        b = c = a;
      for (const Vec3& corner : {a, b, c})
        mesh.vertices.push_back(corner);
      mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    std::iota(all.begin(), all.end(), 0U);
  }
};

/// Number of bricks with any distance different from the tree's.
int different(const Soup& soup, std::mt19937_64& random, int bricks) {
  const voxmap::GridMesh in_grid(soup.mesh, {Vec3::Zero(), 1.0});
  const DistanceTree tree(in_grid, soup.all);
  int wrong = 0;
  for (int n = 0; n < bricks; ++n) {
    const Vec3 first(8.0 * static_cast<double>(random() % 6) - 16.0,
                     8.0 * static_cast<double>(random() % 6) - 16.0,
                     8.0 * static_cast<double>(random() % 6) - 16.0);
    voxmap::BrickLimits limit;
    for (double& most : limit)
      most = random() % 2 == 0 ? -12.0 : 2.0;
    voxmap::DistanceField::Brick brick;
    voxmap::signed_distances(tree, first, limit,
                             n % 3 == 0 ? static_cast<std::uint32_t>(random() % soup.all.size())
                                        : DistanceTree::kNoPlace,
                             brick);
    bool same = true;
    for (int at = 0; at < 512; ++at) {
      const int x = at % 8, y = at / 8 % 8, z = at / 64;
      std::uint32_t place = DistanceTree::kNoPlace;
      const double most = limit[voxmap::own_node(x, y, z)],
                   distance = tree.nearest(first + Vec3(x, y, z), std::abs(most), place);
      same = same &&
             std::bit_cast<std::uint32_t>(static_cast<float>(most < 0.0 ? -distance : distance)) ==
                 std::bit_cast<std::uint32_t>(brick[voxmap::node_of_brick(x, y, z)]);
    }
    wrong += !same;
  }
  return wrong;
}

TEST(BrickDistances, EqualTheTreesForAnyTriangles) {
  std::mt19937_64 random(voxtouch::testing::seed(1));
  for (const auto& [count, size] : {std::pair{std::size_t{1}, 10.0},
                                    {3, 30.0},
                                    {40, 5.0},
                                    {300, 3.0},
                                    {3000, 1.0},
                                    {30000, 0.4}})
    EXPECT_EQ(different(Soup(random, count, size), random, 40), 0)
        << count << " triangles of " << size;
}

TEST(BrickDistances, AreTheLimitsFarFromTriangles) {
  const mesh::TriangleMesh empty;
  const voxmap::GridMesh in_grid(empty, {Vec3::Zero(), 1.0});
  const DistanceTree tree(in_grid, {});
  voxmap::BrickLimits limit;
  limit.fill(-12.0), limit[voxmap::own_node(5, 0, 0)] = 2.0;
  voxmap::DistanceField::Brick brick;
  brick.fill(7.0F);
  voxmap::signed_distances(tree, Vec3::Zero(), limit, DistanceTree::kNoPlace, brick);
  for (int n = 0; n < 729; ++n) {
    const bool own = n % 9 < 8 && n / 9 % 9 < 8 && n / 81 < 8;
    EXPECT_EQ(brick[static_cast<std::size_t>(n)], !own ? 7.0F : n == 5 ? 2.0F : -12.0F);
  }
}

/// Inside, no gradient of the interpolation exceeds the bound, and some nearly reach it, except for
/// its resolution of an eighth of a voxel.
TEST(BrickDistances, RangeOfABrickBoundsNodesAndGradients) {
  std::mt19937_64 random(voxtouch::testing::seed(3));
  std::uniform_real_distribution<double> place(0.0, 1.0);
  for (int attempt = 0; attempt < 20; ++attempt) {
    // Two planes that meet in an edge, from inside or outside, at any angle.
    const Vec3 a = Vec3(place(random) - 0.5, place(random) - 0.5, place(random) - 0.5).normalized(),
               b = Vec3(place(random) - 0.5, place(random) - 0.5, place(random) - 0.5).normalized();
    voxmap::DistanceField::Brick brick;
    for (int n = 0; n < 729; ++n) {
      const Vec3 at = Vec3(n % 9, n / 9 % 9, n / 81) - Vec3::Constant(4.0);
      const double one = a.dot(at) - 0.3, other = b.dot(at) - 0.4;
      brick[static_cast<std::size_t>(n)] =
          static_cast<float>(attempt % 2 == 0 ? std::min(one, other) : std::max(one, other));
    }
    const voxmap::BrickRange range = voxmap::range_of(brick);
    EXPECT_EQ(range.least, *std::min_element(brick.begin(), brick.end()));
    EXPECT_EQ(range.most, *std::max_element(brick.begin(), brick.end()));
    double steepest = 1.0;
    for (int n = 0; n < 200'000; ++n) {
      const int x = static_cast<int>(random() % 8), y = static_cast<int>(random() % 8),
                z = static_cast<int>(random() % 8);
      const Vec3 t(place(random), place(random), place(random));
      double value = 0.0;
      Vec3 gradient = Vec3::Zero();
      for (int c = 0; c < 8; ++c) {
        const double d = brick[voxmap::node_of_brick(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2))];
        const Vec3 w((c & 1) ? t.x() : 1.0 - t.x(), (c >> 1 & 1) ? t.y() : 1.0 - t.y(),
                     (c >> 2) ? t.z() : 1.0 - t.z());
        value += d * w.x() * w.y() * w.z();
        gradient +=
            d * Vec3(((c & 1) ? 1 : -1) * w.y() * w.z(), ((c >> 1 & 1) ? 1 : -1) * w.x() * w.z(),
                     ((c >> 2) ? 1 : -1) * w.x() * w.y());
      }
      if (value < 0.0)
        steepest = std::max(steepest, gradient.squaredNorm());
    }
    EXPECT_LE(steepest, range.steepest_square * (1.0 + 1e-5));
    EXPECT_GE(steepest, 0.75 * range.steepest_square);
  }
}

TEST(BrickDistances, BatchedSquaresMatchSingleOnes) {
  std::mt19937_64 random(voxtouch::testing::seed(2));
  const Soup soup(random, 500, 4.0);
  const voxmap::GridMesh in_grid(soup.mesh, {Vec3::Zero(), 1.0});
  std::uniform_real_distribution<double> place(-15.0, 35.0);
  for (std::uint32_t t = 0; t < 500; ++t) {
    const DistanceTree alone(in_grid, {t});
    DistanceTree::Points points;
    for (std::size_t n = 0; n < DistanceTree::Points::kCount; ++n)
      points.set(n, Vec3(place(random), place(random), place(random)));
    DistanceTree::Squares squares;
    alone.squares(0, points, squares);
    for (std::size_t n = 0; n < squares.size(); ++n) {
      std::uint32_t found = DistanceTree::kNoPlace;
      const double one = alone.nearest(Vec3(points.x[n], points.y[n], points.z[n]), 1e3, found);
      ASSERT_EQ(std::bit_cast<std::uint64_t>(one),
                std::bit_cast<std::uint64_t>(std::sqrt(squares[n])))
          << t;
    }
  }
}

}  // namespace
}  // namespace voxtouch::test::brick_distances
