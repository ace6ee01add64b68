/// No wall is passed, however thin, at any speed.
#include <gtest/gtest.h>

#include <random>

#include "tests/unit/exact/rig.hpp"

namespace voxtouch::exact {
namespace {

/// Throws a ball at a foil in z = 0, from above, and rubs; how many poses intersect, or are below
/// it.
int passed(double thickness, double radius, double speed, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const Quat tilt = turned(uniform(random), {uniform(random), uniform(random), uniform(random)});
  Rig rig(
      test::ball(radius, 2),
      test::moved(test::box({-0.05, -0.05, -thickness}, {0.05, 0.05, 0.0}), {Vec3::Zero(), tilt}));
  const double step = 1e-3 * speed, start = 0.003 + radius + step;
  const Vec3 spin(uniform(random), uniform(random), uniform(random));
  const Vec3 aside(0.01 * uniform(random), 0.01 * uniform(random), 0.0);
  Pose hand{tilt * (aside + Vec3(0, 0, start)), Quat::Identity()};
  if (!rig.virtual_tool.place(hand, {&rig.object_pose, 1}))
    return 1;
  int bad = 0;
  const int frames = std::max(40, static_cast<int>((start + 0.02) / step));
  for (int k = 0; k < frames; ++k) {
    hand.position += tilt * Vec3(0.2 * step, 0.0, -step);
    hand.orientation = (turned(0.02, spin) * hand.orientation).normalized();
    rig.frame(hand);
    if (k % 5 == 0)
      bad += rig.intersects();
    bad += (tilt.conjugate() * rig.virtual_tool.pose().position).z() < 0.0;
  }
  return bad;
}

TEST(Foils, NoneIsPassed) {
  std::mt19937 random(17);
  for (const double thickness : {2e-5, 2e-4, 5e-4})
    for (const double radius : {5e-4, 1.5e-3})
      for (const double speed : {0.1, 1.0, 3.0})
        for (int k = 0; k < 3; ++k)
          EXPECT_EQ(passed(thickness, radius, speed, random), 0) << thickness << ' ' << speed;
  EXPECT_EQ(passed(2e-5, 1.5e-3, 0.02, random), 0);
}

TEST(Foils, EdgeOnAnEdgeDoesNotPass) {
  // A thin rod across the rim of a foil: no vertex of either is near the crossing.
  Rig rig(test::box({-2e-4, -0.02, -2e-4}, {2e-4, 0.02, 2e-4}),
          test::box({-0.02, -1e-5, -0.05}, {0.02, 1e-5, 0.0}));
  const Pose start{{0, 0, 0.002}, turned(0.3, {0.2, 0.3, 1})};
  ASSERT_TRUE(rig.virtual_tool.place(start, {&rig.object_pose, 1}));
  for (int k = 0; k < 60; ++k) {
    rig.frame({start.position - Vec3(0, 0, 1e-4 * k), start.orientation});
    ASSERT_FALSE(rig.intersects()) << k;
  }
  EXPECT_GT(rig.virtual_tool.pose().position.z(), 0.0);
}

}  // namespace
}  // namespace voxtouch::exact
