#include "core/pointshell/clip.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/voxmap/exact_sign.hpp"
#include "core/voxmap/triangle_voxels.hpp"

namespace voxtouch::pointshell {
namespace {

struct Bound {
  double s, t, limit;  ///< s * x + t * y <= limit in the triangle's coordinates
};

/// The least distance from the origin to the points of triangle and cube. It tries every set of up
/// to two active bounds of the quadratic programme in barycentric coordinates, without polygon or
/// clipping.
double least_distance(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 f = b - a, g = c - a;
  std::vector<Bound> bounds{{-1, 0, 0}, {0, -1, 0}, {1, 1, 1}};
  for (int axis = 0; axis < 3; ++axis) {
    bounds.push_back({f[axis], g[axis], 0.5 - a[axis]});
    bounds.push_back({-f[axis], -g[axis], 0.5 + a[axis]});
  }
  double best = INFINITY;
  const auto consider = [&](double s, double t) {
    if (!std::isfinite(s) || !std::isfinite(t))
      return;
    for (const Bound& bound : bounds)
      if (bound.s * s + bound.t * t >
          bound.limit + 1e-12 * (1.0 + std::abs(bound.s) + std::abs(bound.t)))
        return;
    best = std::min(best, (a + s * f + t * g).norm());
  };
  const double ff = f.dot(f), fg = f.dot(g), gg = g.dot(g), af = a.dot(f), ag = a.dot(g);
  const double det = ff * gg - fg * fg;
  consider((fg * ag - gg * af) / det, (fg * af - ff * ag) / det);
  for (std::size_t m = 0; m < bounds.size(); ++m) {
    const Bound& one = bounds[m];
    const double length = one.s * one.s + one.t * one.t;
    if (length == 0.0)
      continue;
    // a point of the line, and its direction
    const double s0 = one.limit * one.s / length, t0 = one.limit * one.t / length;
    const Vec3 x0 = a + s0 * f + t0 * g, along = -one.t * f + one.s * g;
    const double r = -x0.dot(along) / along.squaredNorm();
    consider(s0 - r * one.t, t0 + r * one.s);
    for (std::size_t n = 0; n < m; ++n) {
      const Bound& other = bounds[n];
      const double cross = one.s * other.t - one.t * other.s;
      if (std::abs(cross) < 1e-9 * std::sqrt(length * (other.s * other.s + other.t * other.t)))
        continue;
      consider((one.limit * other.t - one.t * other.limit) / cross,
               (one.s * other.limit - one.limit * other.s) / cross);
    }
  }
  return best;
}

TEST(Clip, NearestPointIsTheConstrainedMinimum) {
  std::mt19937 random(21);
  int met = 0;
  double worst = 0.0;
  for (int n = 0; n < 400000 && met < 60000; ++n) {
    const double size = n % 3 == 0 ? 0.4 : n % 3 == 1 ? 1.5 : 8.0;
    std::uniform_real_distribution<double> corner(-size, size), place(-0.7, 0.7);
    const Vec3 centre(place(random), place(random), place(random));
    std::array<Vec3, 3> x;
    for (Vec3& v : x)
      v = centre + Vec3(corner(random), corner(random), corner(random));
    if (n % 5 == 0)
      for (Vec3& v : x)
        v = (v * 4.0).array().round() / 4.0;  // corners on borders, centres and faces
    const Vec3 normal = voxmap::area_vector(x[0], x[1], x[2]);
    const double longest =
        std::max({(x[1] - x[0]).norm(), (x[2] - x[0]).norm(), (x[2] - x[1]).norm()});
    if (normal.norm() < 1e-2 * longest * longest)
      continue;  // conditioning of the oracle
    const Vec3 shift = Vec3::Constant(0.5);
    if (voxmap::TriangleVoxels(x[0] + shift, x[1] + shift, x[2] + shift).meeting({0, 0, 0}) ==
        voxmap::Meeting::kNone)
      continue;
    ++met;
    const VoxelPolygon polygon = clip_to_voxel(x[0], x[1], x[2]);
    ASSERT_GT(polygon.size, 0);
    const Vec3 p = nearest_to_centre(x, normal.normalized(), polygon);
    ASSERT_LE(p.cwiseAbs().maxCoeff(), 0.5);
    const double off_plane = std::abs(normal.normalized().dot(p - x[0]));
    const double difference = std::abs(p.norm() - least_distance(x[0], x[1], x[2]));
    worst = std::max({worst, off_plane, difference});
    ASSERT_LT(difference, 2e-11) << x[0].transpose() << " | " << x[1].transpose() << " | "
                                 << x[2].transpose();
    ASSERT_LT(off_plane, 1e-12);
  }
  EXPECT_GE(met, 20000);
  std::printf("%d pairs, largest difference %.2g e\n", met, worst);
}

TEST(Clip, SliverIsClippedAtItsEnd) {
  for (int n = 10; n < 300; n += 10) {
    const double thin = std::ldexp(1.0, -n);
    const Vec3 a(0.2, 0.1, 0.1), b(0.4, 0.3, 0.1), c(0.3, 0.2 + thin, 0.1 - thin);
    const Vec3 p = nearest_to_centre({a, b, c}, voxmap::area_vector(a, b, c).stableNormalized(),
                                     clip_to_voxel(a, b, c));
    ASSERT_LT((p - a).norm(), 2 * thin + 1e-15) << n;
  }
}

TEST(Clip, NearestPointOfASliverIsItsEnd) {
  std::mt19937 random(8);
  std::normal_distribution<double> pick;
  for (int n = 0; n < 2000; ++n) {
    const Mat3 turn = Quat(pick(random), pick(random), pick(random), pick(random))
                          .normalized()
                          .toRotationMatrix();
    const double thin = std::ldexp(1.0, -45 - n % 12);
    const Vec3 a = turn * Vec3(0.1, 0, 0.2), b = turn * Vec3(0.3, 0, 0.2),
               c = turn * Vec3(0.2, thin, 0.2);
    const Vec3 p = nearest_to_centre({a, b, c}, turn.col(2), clip_to_voxel(a, b, c));
    ASSERT_LT((p - a).norm(), 1e-12) << n;
  }
}

TEST(Clip, TouchingIsNeverEmpty) {
  const auto nearest = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    return nearest_to_centre({a, b, c}, voxmap::area_vector(a, b, c).stableNormalized(),
                             clip_to_voxel(a, b, c));
  };
  const Vec3 corner = Vec3::Constant(0.5);
  EXPECT_LT((nearest(Vec3(1.5, 0, 0), Vec3(0, 1.5, 0), Vec3(0, 0, 1.5)) - corner).norm(), 1e-9);
  EXPECT_LT((nearest(corner, corner, corner) - corner).norm(), 1e-12);
  EXPECT_LT((nearest(Vec3(0.5, -3, 0.5), Vec3(0.5, 3, 0.5), Vec3(0.5, 1, 0.5)) - Vec3(0.5, 0, 0.5))
                .norm(),
            1e-12);
  EXPECT_LT(
      (nearest(Vec3(0.5, -3, -3), Vec3(0.5, 3, -3), Vec3(0.5, 0, 5)) - Vec3(0.5, 0, 0)).norm(),
      1e-12);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> pick(0.0, 3.0);
  // thirds are not doubles: the cut must handle rounding for touching ones
  for (int n = 0; n < 2000; ++n) {
    const Vec3 far1(0.5 + pick(random), 0.5 - pick(random) / 3, 0.5),
        far2(0.5 + pick(random), 0.5, 0.5 - pick(random) / 3);
    const Vec3 p = nearest(2 * corner - far1, far1, far2 + Vec3(3, 0, 0));
    ASSERT_LT((p - corner).norm(), 1e-6);
    ASSERT_LE(p.cwiseAbs().maxCoeff(), 0.5);
  }
}

TEST(Clip, AreaOfAPlaneThroughTheMiddle) {
  EXPECT_NEAR(area(clip_to_voxel(Vec3(-9, -9, 0), Vec3(9, -9, 0), Vec3(0, 9, 0))), 1.0, 1e-14);
  // The regular hexagon of the cube's main diagonal.
  EXPECT_NEAR(area(clip_to_voxel(Vec3(9, -9, 0), Vec3(0, 9, -9), Vec3(-9, 0, 9))),
              1.299038105676658, 1e-13);
}

}  // namespace
}  // namespace voxtouch::pointshell
