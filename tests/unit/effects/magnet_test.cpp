#include <gtest/gtest.h>

#include <cmath>

#include "effect_check.hpp"

namespace voxtouch::test {
namespace magnet_test {

effects::EffectSpec magnet(const Vec3& point, double radius, double force) {
  return effect("magnet", {{"point", Random::as_array(point)},
                           {"radius_m", {radius, 0, 0}},
                           {"force_n", {force, 0, 0}}});
}

effects::EffectSpec random_magnet(Random& random) {
  effects::EffectSpec spec =
      magnet(random.vector(0.01), random.number(0.005, 0.06), random.number(0.1, 8));
  if (random.coin())
    spec.region = {effects::SphereRegion{random.vector(0.02), random.number(0.005, 0.03)},
                   random.number(0.005, 0.02)};
  spec.gain = random.number(0.2, 1.0);
  return spec;
}

Pose at(const Vec3& x) { return {x, Quat::Identity()}; }

TEST(Magnet, PullPeaksAtItsRadiusOverRootFive) {
  Bench bench(magnet({0.1, 0, 0}, 0.02, 3));
  double most = 0.0, where = 0.0;
  for (int n = 1; n < 4000; ++n) {
    const double r = 1e-5 * n;
    const Vec3 force = bench.at(at({0.1 + r, 0, 0})).wrench.force;
    EXPECT_LE(force.x(), 0.0);
    EXPECT_NEAR(force.y(), 0.0, 1e-15);
    if (-force.x() > most)
      most = -force.x(), where = r;
  }
  EXPECT_NEAR(most, 3.0, 1e-5);
  EXPECT_NEAR(where, 0.02 / std::sqrt(5.0), 1e-5);
  EXPECT_TRUE(bench.at(at({0.1, 0.02, 0})).wrench.zero());
  EXPECT_TRUE(bench.at(at({9, 9, 9})).wrench.zero());
  EXPECT_EQ(bench.at(at({9, 9, 9})).potential_j, 0.0);
  EXPECT_NEAR(bench.at(at({0.1, 0, 0})).potential_j, -25 * std::sqrt(5.0) / 96 * 3 * 0.02, 1e-15);
}

TEST(Magnet, PushesAlongItsPotentialForAnyParameters) {
  Random random(21);
  for (int attempt = 0; attempt < 1000; ++attempt) {
    Bench bench(random_magnet(random));
    expect_force_of_potential(bench, at(random.vector(0.04)), 2e-4);
  }
}

TEST(Magnet, HasAStiffnessAndBoundsThatCoverEveryFiniteDifference) {
  Random random(22);
  for (int attempt = 0; attempt < 1000; ++attempt) {
    Bench bench(random_magnet(random));
    expect_stiffness_covers(bench, at(random.vector(0.04)), 1e-3);
  }
  Bench bench(magnet({0, 0, 0}, 0.02, 3));
  EXPECT_NEAR(bench.at({}).stiffness_bound_n_per_m,
              effects::bound_of(bench.spec()).stiffness_n_per_m, 1e-9)
      << "reached at the point";
  EXPECT_NEAR(effects::bound_of(bench.spec()).stiffness_n_per_m, 3.4939 * 3 / 0.02, 0.02);
}

TEST(Magnet, StepsNowhereOnASweepThroughRimAndPoint) {
  Random random(23);
  for (int attempt = 0; attempt < 40; ++attempt) {
    effects::EffectSpec spec = random_magnet(random);
    spec.region = {}, spec.gain = 1.0;
    Bench bench(spec);
    const Vec3 u = random.direction(),
               off = attempt % 2 == 0 ? Vec3(Vec3::Zero()) : random.vector(0.005);
    const Vec3 middle = spec.values.vector(0) + off;
    EXPECT_LE(steepest_on_sweep(bench, middle - 0.08 * u, middle + 0.08 * u, 20000,
                                effects::bound_of(spec).stiffness_n_per_m),
              1 + 1e-6);
  }
}

TEST(Magnet, GivesNoEnergyOnAnyClosedPath) {
  Random random(24);
  for (int attempt = 0; attempt < 250; ++attempt) {
    Bench bench(random_magnet(random));
    const Work work = work_along(bench, closed_path(random, random.vector(0.01), 0.04, 0.0, 4000));
    EXPECT_LE(std::abs(work.net_j), 1e-3 * work.moved_j + 1e-12) << attempt;
  }
}

TEST(Magnet, IsFiniteAtItsPointItsRimAndFarOff) {
  for (const double radius : {0.0005, 0.02, 10.0})
    for (const double r : {0.0, 1e-320, 1e-200, radius, std::nextafter(radius, 0.0), 1e8}) {
      Bench bench(magnet({0, 0, 0}, radius, 100));
      EXPECT_LE(bench.at(at({r, 0, 0})).wrench.force.norm(), 100 * (1 + 1e-12));
      EXPECT_EQ(bench.chain().not_finite(), 0u);
    }
}

}  // namespace magnet_test
}  // namespace voxtouch::test
