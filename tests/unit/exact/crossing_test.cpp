#include "core/exact/crossing.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/exact/closest.hpp"

namespace voxtouch::exact {
namespace {

using Points = std::array<MovingPoint, 4>;

Points random_points(std::mt19937& random, double step) {
  std::normal_distribution<double> normal;
  Points points;
  for (MovingPoint& p : points) {
    p.from = Vec3(normal(random), normal(random), normal(random));
    p.to = p.from + step * Vec3(normal(random), normal(random), normal(random));
  }
  return points;
}

/// Least distance over the step, from 20,000 times: no less than the truth.
template <class Distance>
double least_distance(const Distance& distance) {
  double least = distance(0.0);
  for (int k = 1; k <= 20000; ++k)
    least = std::min(least, distance(k / 20000.0));
  return least;
}

TEST(Crossing, FindsExactlyTheVerticesThatCross) {
  std::mt19937 random(1);
  int passed = 0;
  for (int k = 0; k < 600; ++k) {
    const Points p = random_points(random, k % 2 == 0 ? 1.0 : 0.3);
    const double least = least_distance([&](double t) {
      const Vec3 v = p[3].at(t);
      return (v - nearest_on_triangle(v, p[0].at(t), p[1].at(t), p[2].at(t)).point).norm();
    });
    const bool found = vertex_passes_face(p[3], {p[0], p[1], p[2]});
    passed += found;
    EXPECT_EQ(found, least < 3e-4) << least;  // a passage is detected within half a time step
  }
  EXPECT_GT(passed, 10);
}

TEST(Crossing, FindsExactlyTheEdgesThatCross) {
  std::mt19937 random(2);
  int passed = 0;
  for (int k = 0; k < 600; ++k) {
    const Points p = random_points(random, k % 2 == 0 ? 1.0 : 0.3);
    const double least = least_distance([&](double t) {
      const Vec3 a = p[0].at(t), b = p[2].at(t);
      return segment_distance(a, p[1].at(t) - a, b, p[3].at(t) - b);
    });
    const bool found = edges_pass({p[0], p[1]}, {p[2], p[3]});
    passed += found;
    EXPECT_EQ(found, least < 3e-4) << least;
  }
  EXPECT_GT(passed, 10);
}

TEST(Crossing, FindsABarelyCrossingStep) {
  const std::array<MovingPoint, 3> face{MovingPoint{{0, 0, 0}, {0, 0, 0}},
                                        MovingPoint{{1, 0, 0}, {1, 0, 0}},
                                        MovingPoint{{0, 1, 0}, {0, 1, 0}}};
  for (const double depth : {1e-3, 1e-8, 1e-14}) {
    EXPECT_TRUE(vertex_passes_face({{0.3, 0.3, 0.7}, {0.3, 0.3, -depth}}, face));
    EXPECT_FALSE(vertex_passes_face({{0.3, 0.3, 0.7}, {0.3, 0.3, 1e-8 + depth}}, face));
  }
}

TEST(Crossing, ParallelEdgesThatSlideDoNotPass) {
  for (const double gap : {1e-7, 1e-3}) {
    const std::array<MovingPoint, 2> moves{MovingPoint{{0, 0, gap}, {0.3, 0.1, gap}},
                                           MovingPoint{{1, 0, gap}, {1.3, 0.1, gap}}};
    const std::array<MovingPoint, 2> rests{MovingPoint{{0, 0, 0}, {0, 0, 0}},
                                           MovingPoint{{1, 0, 0}, {1, 0, 0}}};
    EXPECT_FALSE(edges_pass(moves, rests));
  }
}

}  // namespace
}  // namespace voxtouch::exact
