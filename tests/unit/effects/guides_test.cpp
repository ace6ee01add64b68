#include <gtest/gtest.h>

#include <cmath>

#include "effect_check.hpp"
#include "tests/unit/effects/chain_change.hpp"

namespace voxtouch::test {
namespace {

constexpr std::array<double, 3> kHold{0, 0, 0}, kRelease{1, 0, 0}, kOne{1, 0, 0}, kSegment{1, 0, 0};
const std::array<double, 3> kAskew = Random::as_array(Vec3(1, 2, -2) / 3.0);

std::array<double, 3> just(double number) { return {number, 0, 0}; }

Pose at(const Vec3& x) { return {x, Quat::Identity()}; }

Mat3 translation(const effects::EffectForce& push) { return push.stiffness.topLeftCorner<3, 3>(); }

/// k = 200 N/m, F = 2 N: w = 10 mm; bends from 5 to 15 mm.
effects::EffectSpec point_guide(bool release = false) {
  return effect("guide_point", {{"stiffness_n_per_m", just(200)},
                                {"limit_n", just(2)},
                                {"point", {0.1, 0.2, 0.3}},
                                {"beyond", release ? kRelease : kHold},
                                {"range_m", just(release ? 0.06 : 0.0)}});
}
effects::EffectSpec line_guide(double half_length) {
  return effect("guide_line", {{"stiffness_n_per_m", just(200)},
                               {"limit_n", just(2)},
                               {"point", {0, 0, 0}},
                               {"direction", {0, 0, 1}},
                               {"ends", half_length > 0 ? kSegment : kHold},
                               {"half_length_m", just(half_length)}});
}
effects::EffectSpec plane_guide(bool one_sided) {
  return effect("guide_plane", {{"stiffness_n_per_m", just(200)},
                                {"limit_n", just(2)},
                                {"point", {0, 0, 0.05}},
                                {"normal", {0, 0, 1}},
                                {"sides", one_sided ? kOne : std::array<double, 3>{}}});
}

/// Any guide with any parameters that it takes, sometimes behind a region.
effects::EffectSpec random_guide(Random& random, int which) {
  const double k = random.number(20, 2000), limit = random.number(0.1, 10);
  const bool release = random.coin();
  const double range = release ? limit / k * random.number(3.0, 12.0) : 0.0;
  const bool segment = random.coin(), one = random.coin();
  effects::EffectSpec spec = which == 0   ? point_guide()
                             : which == 1 ? line_guide(segment ? random.number(0.002, 0.05) : 0.0)
                                          : plane_guide(one);
  spec.values.at(0) = just(k), spec.values.at(1) = just(limit),
  spec.values.at(2) = release ? kRelease : kHold;
  spec.values.at(3) = just(range), spec.values.at(4) = random.three(0.02);
  if (which > 0)
    spec.values.at(5) = Random::as_array(random.direction());
  if (random.coin()) {
    spec.region.blend_m = random.number(0.005, 0.02);
    if (random.coin())
      spec.region.shape = effects::SphereRegion{random.vector(0.03), random.number(0.005, 0.04)};
    else
      spec.region.shape =
          effects::BoxRegion{{random.vector(0.03), random.orientation()}, Vec3(0.02, 0.03, 0.04)};
  }
  spec.gain = random.number(0.2, 1.0);
  return spec;
}

TEST(GuidePoint, PullsAsASpringUpToItsLimit) {
  Bench bench(point_guide());
  const Vec3 p(0.1, 0.2, 0.3), u = Vec3(2, -1, 2) / 3.0;
  const auto force = [&](double s) { return -bench.at(at(p + s * u)).wrench.force.dot(u); };
  EXPECT_TRUE(bench.at(at(p)).wrench.zero());
  EXPECT_NEAR(force(0.004), 0.8, 1e-12);
  EXPECT_NEAR(force(0.010), 1.75, 1e-12);
  EXPECT_NEAR(force(0.015), 2.0, 1e-12);
  EXPECT_NEAR(force(5.0), 2.0, 1e-12);
  EXPECT_NEAR(bench.at(at(p + 0.004 * u)).potential_j, 0.0016, 1e-14);
  EXPECT_NEAR(bench.at(at(p + 0.015 * u)).potential_j, 0.02 * 23 / 24, 1e-13);
  EXPECT_NEAR(bench.at(at(p + 0.115 * u)).potential_j, 0.02 * 23 / 24 + 0.2, 1e-13);
  EXPECT_TRUE(translation(bench.at(at(p + 0.004 * u))).isApprox(200 * Mat3::Identity()));
  EXPECT_TRUE(std::isinf(effects::bound_of(bench.spec()).potential_j));
}

TEST(GuidePoint, ReleasesAtItsRangeIfConfigured) {
  Bench bench(point_guide(true));
  const Vec3 p(0.1, 0.2, 0.3);
  const auto pull = [&](double s) { return bench.at(at(p + s * Vec3::UnitX())); };
  EXPECT_NEAR(pull(0.03).wrench.force.x(), -2.0, 1e-12);
  EXPECT_NEAR(pull(0.045).wrench.force.x(), -1.0, 1e-12);
  EXPECT_TRUE(pull(0.06).wrench.force.isZero(1e-12));
  EXPECT_TRUE(pull(0.5).wrench.zero());
  EXPECT_NEAR(pull(0.5).potential_j, 0.0, 1e-15);
  EXPECT_NEAR(pull(0.0).potential_j, -(0.02 * 23 / 24 + 2 * 0.015 + 2 * 0.015), 1e-13);
  EXPECT_NEAR(effects::bound_of(bench.spec()).potential_j, -pull(0.0).potential_j, 1e-13);
}

TEST(GuideLine, HoldsAcrossAndIsFreeAlong) {
  Bench bench(line_guide(0));
  const effects::EffectForce push = bench.at(at({0.003, 0.004, 7.0}));
  EXPECT_TRUE(push.wrench.force.isApprox(-200 * Vec3(0.003, 0.004, 0)));
  EXPECT_TRUE(translation(push).isApprox(Mat3(Vec3(200, 200, 0).asDiagonal())));
}

TEST(GuideLine, OfFiniteLengthHoldsAtItsEnds) {
  Bench bench(line_guide(0.02));
  EXPECT_TRUE(
      bench.at(at({0.003, 0.004, 0.019})).wrench.force.isApprox(-200 * Vec3(0.003, 0.004, 0)));
  EXPECT_TRUE(
      bench.at(at({0.0, 0.001, 0.022})).wrench.force.isApprox(-200 * Vec3(0, 0.001, 0.002)));
  EXPECT_TRUE(
      bench.at(at({0.0, 0.001, -0.022})).wrench.force.isApprox(-200 * Vec3(0, 0.001, -0.002)));
  EXPECT_TRUE(bench.at(at({0, 0, -0.011})).wrench.zero());
}

TEST(GuidePlane, TwoSidedHoldsAndOneSidedKeepsOut) {
  Bench both(plane_guide(false)), one(plane_guide(true));
  EXPECT_TRUE(both.at(at({3, 4, 0.052})).wrench.force.isApprox(Vec3(0, 0, -0.4)));
  EXPECT_TRUE(both.at(at({3, 4, 0.048})).wrench.force.isApprox(Vec3(0, 0, 0.4)));
  EXPECT_TRUE(one.at(at({3, 4, 0.052})).wrench.zero());
  EXPECT_TRUE(one.at(at({3, 4, 0.052})).stiffness.isZero(0.0));
  EXPECT_EQ(one.at(at({3, 4, 0.052})).potential_j, 0.0);
  EXPECT_TRUE(one.at(at({3, 4, 0.048})).wrench.force.isApprox(Vec3(0, 0, 0.4)));
  EXPECT_NEAR(one.at(at({3, 4, -7})).wrench.force.z(), 2.0, 1e-12);
  EXPECT_NEAR(both.at(at({0, 0, 0.048})).stiffness(2, 2), 200, 1e-9);
}

TEST(Guides, PushAlongTheirPotentialForAnyParameters) {
  Random random(11);
  for (int attempt = 0; attempt < 1000; ++attempt) {
    Bench bench(random_guide(random, attempt % 3));
    expect_force_of_potential(bench, at(random.vector(0.06)), 2e-4);
  }
}

TEST(Guides, HaveAStiffnessAndBoundsThatCoverEveryFiniteDifference) {
  Random random(12);
  for (int attempt = 0; attempt < 3000; ++attempt) {
    Bench bench(random_guide(random, attempt % 3));
    expect_stiffness_covers(bench, at(random.vector(0.06)), 1e-3);
  }
}

TEST(Guides, ReachTheirBound) {
  Bench bench(point_guide(true));
  double most = 0.0;
  for (int n = 0; n < 700; ++n)
    most = std::max(most, bench.at(at({0.1 + 1e-4 * n, 0.2, 0.3})).stiffness_bound_n_per_m);
  EXPECT_DOUBLE_EQ(most, effects::bound_of(bench.spec()).stiffness_n_per_m);
}

TEST(Guides, StepNowhereOnASweepThroughSidesLimitsEndsAndRims) {
  Random random(13);
  for (int attempt = 0; attempt < 60; ++attempt) {
    effects::EffectSpec spec = random_guide(random, attempt % 3);
    const double k = spec.gain * spec.values.number(0);
    spec.region = {};
    Bench bench(spec);
    const Vec3 middle = spec.values.vector(4);
    for (const Vec3& u :
         {random.direction(), attempt % 3 > 0 ? spec.values.vector(5) : random.direction()})
      EXPECT_LE(steepest_on_sweep(bench, middle - 0.3 * u, middle + 0.3 * u, 20000, k), 1 + 1e-6);
  }
}

TEST(Guides, GiveNoEnergyOnAnyClosedPath) {
  Random random(14);
  double most = 0.0;
  for (int attempt = 0; attempt < 300; ++attempt) {
    Bench bench(random_guide(random, attempt % 3));
    const Work work = work_along(bench, closed_path(random, random.vector(0.01), 0.05, 0.0, 4000));
    EXPECT_LE(std::abs(work.net_j), 1e-3 * work.moved_j + 1e-12) << attempt;
    if (work.moved_j > 1e-6)
      most = std::max(most, std::abs(work.net_j) / work.moved_j);
  }
  RecordProperty("largest_share", std::to_string(most));
  EXPECT_GT(most, 0.0);
}

TEST(Guides, LeaveLessEnergyTheFinerAPathIsSampled) {
  Random random(15);
  double coarse = 0.0, fine = 0.0;
  for (int attempt = 0; attempt < 60; ++attempt) {
    Bench bench(random_guide(random, attempt % 3));
    Random again(100 + static_cast<unsigned>(attempt)), same = again;
    coarse += std::abs(work_along(bench, closed_path(again, Vec3::Zero(), 0.05, 0.0, 1000)).net_j);
    fine += std::abs(work_along(bench, closed_path(same, Vec3::Zero(), 0.05, 0.0, 8000)).net_j);
  }
  EXPECT_LT(fine, coarse / 16);  // 64 without sharp bends
}

TEST(Guides, AreFiniteOnThemFarAwayAndAtZeroForce) {
  for (effects::EffectSpec spec : {point_guide(), point_guide(true), line_guide(0),
                                   line_guide(0.02), plane_guide(false), plane_guide(true)})
    for (const double k : {0.0, 1e-300, 200.0})
      for (const double limit : {0.0, 1e-300, 2.0})
        for (const Vec3& x : {Vec3(0.1, 0.2, 0.3), Vec3(0, 0, 0), Vec3(0, 0, 0.02),
                              Vec3(1e-320, 0, 0), Vec3(1e6, -1e6, 1e6)}) {
          if (spec.values.number(2) > 0.0 && k < 200.0)
            continue;  // refused: see below
          spec.values.at(0) = just(k), spec.values.at(1) = just(limit);
          Bench bench(spec);
          const effects::EffectForce push = bench.at(at(x));
          EXPECT_EQ(bench.chain().not_finite(), 0u) << spec.name << k << limit << x.transpose();
          EXPECT_LE(push.wrench.force.norm(), limit * (1 + 1e-9));
        }
}

TEST(Guides, RefuseContradictionsWithAMessage) {
  const auto why = [](effects::EffectSpec spec, std::size_t p, std::array<double, 3> value) {
    spec.values.at(p) = value;
    return effects::check_values(*spec.kind, spec.values);
  };
  EXPECT_EQ(effects::check_values(*point_guide().kind, point_guide().values), "");
  EXPECT_NE(why(point_guide(), 3, just(0.1)).find("'beyond: release'"), std::string::npos);
  EXPECT_NE(
      why(point_guide(true), 3, just(0.029)).find("minimum 3 limit_n / stiffness_n_per_m = 0.03 m"),
      std::string::npos);
  EXPECT_NE(why(point_guide(true), 3, just(0.0)), "");
  EXPECT_NE(why(point_guide(true), 0, just(0.0)), "");
  EXPECT_NE(why(line_guide(0), 7, just(0.1)).find("'ends: segment'"), std::string::npos);
  EXPECT_NE(why(line_guide(0.1), 7, just(0.0)).find("'half_length_m'"), std::string::npos);
}

TEST(Guides, StayWithinTheirStiffnessDuringAnyChange) {
  effects::EffectSpec spec = point_guide(true);
  spec.values.at(0) = just(100), spec.values.at(1) = just(1), spec.values.at(3) = just(0.03);
  Bench bench(spec);
  EXPECT_EQ(set_value(bench.chain(), "range_m", just(0.3)), "");
  EXPECT_EQ(set_value(bench.chain(), "stiffness_n_per_m", just(1000)), "");
  EXPECT_EQ(set_value(bench.chain(), "limit_n", just(100)), "");
  for (int n = 1; n <= 100; ++n) {  // in between 3 F / R exceeds k
    const double displacement = 0.01 * n;
    const effects::EffectForce push =
        bench.at(at({0.1 + 0.75 * (0.03 + 0.27 * displacement), 0.2, 0.3}));
    EXPECT_LE(push.stiffness_bound_n_per_m, (100 + 900 * displacement) * (1 + 1e-9)) << n;
  }
}

TEST(Guides, RotatedAndMovedAtRunTimeMakeNoForceStep) {
  for (effects::EffectSpec spec :
       {line_guide(0), line_guide(0.02), plane_guide(false), plane_guide(true)}) {
    Bench bench(spec);
    const Pose pose = at({0.004, -0.003, 0.012});
    Vec3 last = bench.at(pose).wrench.force;
    const char* const turned = spec.name == "guide_plane" ? "normal" : "direction";
    EXPECT_EQ(set_value(bench.chain(), turned, {0, 0, -1}), "");
    double most = 0.0;
    for (int n = 0; n < 250; ++n) {
      if (n == 120) {
        EXPECT_EQ(set_value(bench.chain(), turned, kAskew), "");
      }
      if (n == 130) {
        EXPECT_EQ(set_value(bench.chain(), "stiffness_n_per_m", just(900)), "");
      }
      const Vec3 force = bench.at(pose).wrench.force;
      EXPECT_TRUE(force.allFinite());
      most = std::max(most, (force - last).norm());
      last = force;
    }
    EXPECT_LT(most, 0.35) << spec.name;
  }
}

}  // namespace
}  // namespace voxtouch::test
