// The effect `proximity`: its law, its bounds and its energy.
#include <gtest/gtest.h>

#include "proximity_ground.hpp"
#include "tests/support/heap_count/heap_count.hpp"
#include "tests/unit/effects/chain_change.hpp"

namespace voxtouch::test {
namespace {

constexpr double kRange = 0.01;

const rendering::ProximityField& block(double h) {
  static const rendering::ProximityField fine = ground_of(block_mesh(), kRange, 0.002),
                                         soft = ground_of(block_mesh(), kRange, 0.004);
  return h > 0.003 ? soft : fine;
}

Pose at(const Vec3& x) { return {x, Quat::Identity()}; }

/// A pose of a tool of 10 mm around the block, often near it.
Pose near_block(Random& random) {
  const Vec3 x = random.vector(0.05);
  return {
      Vec3(x.x(), x.y(), random.coin() ? x.z() : std::copysign(random.number(0.028, 0.04), x.z())),
      random.orientation()};
}

effects::EffectSpec random_proximity(Random& random, double h, double lever) {
  const double range = random.number(0.3, 1.0) * kRange;
  effects::EffectSpec spec = proximity(random.number(0.1, 8), range, h, lever);
  spec.gain = random.number(0.2, 1.0);
  if (random.coin())
    spec.region = {effects::SphereRegion{random.vector(0.04), random.number(0.01, 0.04)},
                   random.number(0.005, 0.02)};
  return spec;
}

TEST(Proximity, PushesAPointOffAFlatWallByASmoothstepOfItsDistance) {
  const std::vector<effects::ToolPoint> point = {{Vec3(0.001, 0, 0), 1.0}};
  Bench bench(proximity(4.0, kRange, 0.002), &block(0.002), point);
  const auto push = [&](double d) { return bench.at(at({0, 0, 0.02 + d})); };
  EXPECT_TRUE(push(0.0101).wrench.zero());
  EXPECT_TRUE(push(0.5).wrench.zero());
  EXPECT_NEAR(push(0.005).wrench.force.z(), 2.0, 1e-4);
  EXPECT_NEAR(push(0.0025).wrench.force.z(), 4.0 * 0.84375, 1e-4);
  EXPECT_NEAR(push(0.0).wrench.force.z(), 4.0, 1e-4);
  EXPECT_NEAR(push(-0.005).wrench.force.z(), 2.0, 1e-4) << "fades inside";
  EXPECT_NEAR(push(0.005).potential_j, 4.0 * kRange * (1.0 / 8 - 1.0 / 32), 1e-7);
  EXPECT_NEAR(push(0.0).potential_j, 4.0 * kRange / 2, 1e-7);
  EXPECT_NEAR(push(0.005).stiffness_bound_n_per_m, 1.5 * 4.0 / kRange, 1.0);
  EXPECT_NEAR(push(0.005).stiffness(2, 2), 1.5 * 4.0 / kRange, 1.0);
  EXPECT_TRUE(push(0.005).wrench.torque.isZero(0.0)) << "no lever was given";
}

TEST(Proximity, IsTheSameForMorePointsOnTheSameTool) {
  const auto force = [&](std::size_t count) {
    const std::vector<effects::ToolPoint> points = ball(0.01, count);
    Bench bench(proximity(4.0, kRange, 0.002), &block(0.002), points);
    return bench.at(at({0, 0, 0.02 + 0.01 + 0.002}));
  };
  // The ball's cap within the range: force F / 2R integral of S(1 - d/R') cos over d in 2..10 mm.
  double exact = 0.0;
  for (int n = 0; n < 8000; ++n) {
    const double d = 0.002 + 1e-6 * (n + 0.5), u = 1.0 - d / kRange;
    exact += 4.0 * u * u * (3 - 2 * u) * 1e-6 / 0.02;
  }
  EXPECT_NEAR(force(20000).wrench.force.z(), exact, 0.002 * exact);
  EXPECT_NEAR(force(128).wrench.force.z(), exact, 0.05 * exact);
  EXPECT_NEAR(force(128).stiffness_bound_n_per_m, force(20000).stiffness_bound_n_per_m,
              0.05 * force(20000).stiffness_bound_n_per_m);
}

TEST(Proximity, GivesTorqueOnlyWithALever) {
  const std::vector<effects::ToolPoint> points = ball(0.005, 64, {0.02, 0, 0});
  Bench with(proximity(4.0, kRange, 0.002, 0.03), &block(0.002), points),
      without(proximity(4.0, kRange, 0.002), &block(0.002), points);
  const Pose pose = at({-0.02, 0, 0.027});
  EXPECT_TRUE(without.at(pose).wrench.torque.isZero(0.0));
  EXPECT_FALSE(without.spec().kind->needs(without.spec().values).torque);
  EXPECT_TRUE(with.spec().kind->needs(with.spec().values).torque);
  const Wrench wrench = with.at(pose).wrench;
  EXPECT_TRUE(wrench.force.isApprox(without.at(pose).wrench.force));
  EXPECT_NEAR(wrench.torque.y(), -0.02 * wrench.force.z(), 0.02 * 0.02 * wrench.force.z());
  EXPECT_TRUE(std::isinf(effects::needs_of(std::vector{without.spec()}).lever_m));
  EXPECT_EQ(effects::needs_of(std::vector{without.spec(), with.spec()}).lever_m, 0.03);
}

TEST(Proximity, ForceAndTorqueFollowItsPotential) {
  Random random(41);
  const std::vector<effects::ToolPoint> points = ball(0.008, 100, {0.004, 0, -0.002});
  int with_force = 0;
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const double h = attempt % 2 ? 0.002 : 0.004;
    Bench bench(random_proximity(random, h, 0.02), &block(h), points);
    const Pose pose = near_block(random);
    with_force += bench.at(pose).wrench.force.norm() > 0.01;
    expect_force_of_potential(bench, pose, 1e-3, true);
  }
  EXPECT_GT(with_force, 150);
}

TEST(Proximity, BoundsCoverEveryFiniteDifference) {
  Random random(42);
  const std::vector<effects::ToolPoint> points = ball(0.008, 100, {0.004, 0, -0.002});
  for (int attempt = 0; attempt < 1500; ++attempt) {
    const double h = attempt % 2 ? 0.002 : 0.004;
    const bool rotation = attempt % 3 > 0;
    effects::EffectSpec spec = random_proximity(random, h, rotation ? 0.013 : 0.0);
    if (rotation)
      spec.region = {};
    Bench bench(spec, &block(h), points);
    expect_stiffness_covers(bench, near_block(random), 0.3, rotation, 1e-8);
  }
  // One point alone may sit right at an edge.
  const std::vector<effects::ToolPoint> point = ball(0.0, 1);
  for (int attempt = 0; attempt < 1500; ++attempt) {
    Bench bench(random_proximity(random, 0.002, 0.0), &block(0.002), point);
    expect_stiffness_covers(bench, {random.vector(0.04), Quat::Identity()}, 0.3, false, 1e-8);
  }
}

TEST(Proximity, StepsNowhereOnASweepThroughRimEdgeAndInside) {
  Random random(43);
  const std::vector<effects::ToolPoint> points = ball(0.008, 100), point = ball(0.0, 1);
  for (int attempt = 0; attempt < 20; ++attempt) {
    const effects::EffectSpec spec = proximity(4.0, kRange, 0.002);
    Bench bench(spec, &block(0.002), attempt % 2 ? points : point);
    const Vec3 u = random.direction(), middle = random.vector(0.03);
    EXPECT_LE(steepest_on_sweep(bench, middle - 0.08 * u, middle + 0.08 * u, 4000,
                                effects::bound_of(spec).stiffness_n_per_m),
              1 + 1e-6);
  }
}

TEST(Proximity, GivesNoEnergyOnAnyClosedPath) {
  Random random(44);
  const std::vector<effects::ToolPoint> points = ball(0.008, 30, {0.004, 0, -0.002});
  double with_force = 0.0;
  for (int attempt = 0; attempt < 200; ++attempt) {
    const double h = attempt % 2 ? 0.002 : 0.004;
    const bool rotation = attempt % 4 < 2;
    Bench bench(random_proximity(random, h, rotation ? 0.013 : 0.0), &block(h), points);
    const Pose start = near_block(random);
    const Work work = work_along(
        bench, closed_path(random, start.position, 0.02, rotation ? 1.0 : 0.0, 1000), rotation);
    EXPECT_LE(std::abs(work.net_j), 2e-3 * work.moved_j + 1e-12) << attempt;
    with_force += work.moved_j;
  }
  EXPECT_GT(with_force, 0.1);
}

TEST(Proximity, LeavesLessEnergyTheFinerAPathIsSampled) {
  const std::vector<effects::ToolPoint> points = ball(0.008, 60);
  double coarse = 0.0, fine = 0.0;
  for (unsigned attempt = 0; attempt < 20; ++attempt) {
    Bench bench(proximity(4.0, kRange, 0.002), &block(0.002), points);
    Random random(500 + attempt), same = random;
    coarse +=
        std::abs(work_along(bench, closed_path(random, {0.02, 0, 0.025}, 0.02, 0.0, 500)).net_j);
    fine += std::abs(work_along(bench, closed_path(same, {0.02, 0, 0.025}, 0.02, 0.0, 4000)).net_j);
  }
  EXPECT_LT(fine, coarse / 16);
}

TEST(Proximity, WithoutDistancesGivesNothing) {
  Bench bench(proximity(4.0, kRange, 0.002));
  EXPECT_TRUE(bench.at({}).wrench.zero());
  const std::vector<effects::ToolPoint> points = ball(0.008, 60);
  Bench far(proximity(4.0, kRange, 0.002), &block(0.002), points);
  for (const double x : {1.0, 1e9, 1e200})
    EXPECT_TRUE(far.at(at({x, 0, 0})).wrench.zero());
  EXPECT_EQ(far.chain().not_finite(), 0u);
}

TEST(Proximity, RefusesChangesBeyondTheBuiltField) {
  Bench bench(proximity(4.0, kRange, 0.002));
  EXPECT_EQ(set_value(bench.chain(), "range_m", {0.008, 0, 0}), "");
  EXPECT_NE(set_value(bench.chain(), "range_m", {0.02, 0, 0}), "");
  EXPECT_NE(set_value(bench.chain(), "smoothing_m", {0.004, 0, 0}), "");
  EXPECT_NE(set_value(bench.chain(), "lever_m", {0.02, 0, 0}), "");
  EXPECT_EQ(set_value(bench.chain(), "limit_n", {1, 0, 0}), "");
  const effects::EffectSpec spec = proximity(4.0, 0.001, 0.005);
  EXPECT_NE(effects::check_values(*spec.kind, spec.values).find("'range_m'"), std::string::npos);
}

TEST(SpaceEffects, AllocateNothingWhileTheyRun) {
  if (!heap_is_counted())
    GTEST_SKIP() << "the sanitizer owns malloc";
  const std::vector<effects::ToolPoint> points = ball(0.008, 100);
  std::vector<effects::EffectSpec> specs = {
      proximity(4.0, kRange, 0.002, 0.02),
      effect("magnet",
             {{"point", {0, 0, 0.03}}, {"radius_m", {0.02, 0, 0}}, {"force_n", {2, 0, 0}}}),
      effect("guide_point",
             {{"stiffness_n_per_m", {200, 0, 0}}, {"limit_n", {2, 0, 0}}, {"point", {0, 0, 0}}}),
      effect("guide_line", {{"stiffness_n_per_m", {200, 0, 0}},
                            {"limit_n", {2, 0, 0}},
                            {"point", {0, 0, 0}},
                            {"direction", {0, 0, 1}}}),
      effect("guide_plane", {{"stiffness_n_per_m", {200, 0, 0}},
                             {"limit_n", {2, 0, 0}},
                             {"point", {0, 0, 0}},
                             {"normal", {0, 0, 1}}})};
  const rendering::ProximityField& field = block(0.002);
  effects::EffectChain chain(std::move(specs));
  effects::EffectFrame frame;
  frame.dt_s = 0.001, frame.proximity = &field, frame.tool_points = points;
  double with_force = 0.0;
  EXPECT_EQ(heap_count_of([&] {
              for (int n = 0; n < 500; ++n) {
                frame.tool = {Vec3(0.0001 * n, 0, 0.03),
                              Quat(Eigen::AngleAxisd(0.01 * n, Vec3::UnitX()))};
                with_force += chain.apply(frame).wrench.force.norm();
              }
            }),
            0);
  EXPECT_GT(with_force, 1.0);
}

}  // namespace
}  // namespace voxtouch::test
