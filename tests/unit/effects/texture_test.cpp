#include "core/effects/texture_pattern.hpp"
#include "tests/unit/effects/chain_change.hpp"
#include "tests/unit/effects/touch_support.hpp"

namespace voxtouch::test {
namespace texture_test {

enum : int { kGrating, kNoise };
const BallTool kBall;
const Vec3 kUp = Vec3::UnitZ();

effects::EffectSpec texture(int pattern, double wavelength_m, double force_n,
                            const Vec3& direction = Vec3::UnitX()) {
  return effect("texture", {{"pattern", {static_cast<double>(pattern)}},
                            {"wavelength_m", {wavelength_m}},
                            {"force_n", {force_n}},
                            {"direction", {direction.x(), direction.y(), direction.z()}}});
}
Pose pressing(double force_n, double x, double y = 0.0) {
  return {Vec3(x, y, 0.01 - force_n / 1000.0), Quat::Identity()};
}
contact::ContactResult plane(const Pose& pose) { return on_plane(pose, kBall, kUp, 0, 1000); }
effects::EffectSpec any_texture(std::mt19937_64& random) {
  const double heading = between(random, 0, 2 * M_PI);
  effects::EffectSpec spec =
      texture(random() % 2 == 0 ? kGrating : kNoise, scale_between(random, 0.0005, 0.05),
              scale_between(random, 0.05, 20), Vec3(std::cos(heading), std::sin(heading), 0));
  spec.values.at(4)[0] = scale_between(random, 0.05, 5);
  return spec;
}

TEST(TexturePattern, SlopeMatchesItsHeightAndBendIsBounded) {
  std::mt19937_64 random(1);
  for (const int pattern : {kGrating, kNoise}) {
    const double wave = 0.002;
    const Vec3 direction = Vec3(1, 2, -1).normalized();
    const auto at = [&](const Vec3& x) {
      return pattern == kGrating ? effects::grating_at(x, wave, direction)
                                 : effects::noise_at(x, wave);
    };
    double steepest = 0.0, bent = 0.0, sum = 0.0;
    for (int n = 0; n < 60000; ++n) {
      const Vec3 x(between(random, -0.1, 0.1), between(random, -0.1, 0.1),
                   between(random, -0.1, 0.1));
      const effects::PatternSample here = at(x);
      const double h = 1e-8;
      Mat3 bend;
      for (int a = 0; a < 3; ++a) {
        const effects::PatternSample more = at(x + h * Vec3::Unit(a)),
                                     less = at(x - h * Vec3::Unit(a));
        ASSERT_NEAR((more.height_m - less.height_m) / (2 * h), here.slope[a], 2e-6);
        bend.col(a) = (more.slope - less.slope) / (2 * h);
      }
      steepest = std::max(steepest, here.slope.norm()), bent = std::max(bent, norm_of(bend));
      sum += here.height_m;
    }
    const double bound = (pattern == kGrating ? effects::kGratingBend : effects::kNoiseBend) / wave;
    EXPECT_LE(steepest, 1 + 1e-12);
    EXPECT_GT(steepest, 0.6);
    EXPECT_LE(bent, bound * (1 + 1e-6));
    EXPECT_GT(bent, 0.6 * bound);
    EXPECT_LT(std::abs(sum / 60000), 0.02 * wave) << "neither up nor down on the whole";
  }
  EXPECT_EQ(effects::noise_at(Vec3(1e300, 0, 0), 0.001).slope, Vec3::Zero());
}

TEST(Texture, OfAGratingIsTheSlopeOfASineAcrossItsRidges) {
  const Vec3 direction = Vec3(1, 1, 0).normalized();
  Asked asked(texture(kGrating, 0.004, 0.3, direction));
  for (int n = 0; n < 1000; ++n) {
    const Pose pose = pressing(2.0, 1e-5 * n, -3e-6 * n);
    const double s = direction.dot(pose.position);
    EXPECT_TRUE(
        asked.at(pose, {plane(pose)})
            .wrench.force.isApprox(-0.3 * std::cos(2 * M_PI * s / 0.004) * direction, 1e-6));
  }
}

TEST(Texture, PushesAlongTheSurfaceOnlyAndNotInFreeSpace) {
  for (const int pattern : {kGrating, kNoise}) {
    Asked asked(texture(pattern, 0.003, 1.0, Vec3(0.6, 0, 0.8)));
    double last_push = 0.0, most = 0.0;
    for (int n = 0; n < 500; ++n) {
      const double force_n = 0.004 * n - 1.0;
      const Pose pose = pressing(force_n, 0.0001);
      const Vec3 force = asked.at(pose, {plane(pose)}).wrench.force;
      EXPECT_NEAR(force.z(), 0.0, 1e-15);
      if (force_n <= 0) {
        EXPECT_EQ(force, Vec3::Zero());
      }
      EXPECT_LE(std::abs(force.norm() - last_push), 0.05) << "a step at the begin of the contact";
      most = std::max(most, last_push = force.norm());
    }
    EXPECT_GT(most, 0.01);
  }
}

TEST(Texture, OnAFlatSurfaceConservesEnergy) {
  std::mt19937_64 random(77);
  for (int attempt = 0; attempt < 220; ++attempt) {
    effects::EffectSpec spec = any_texture(random);
    const double wave = spec.values.number(1), full = spec.values.number(4);
    const ClosedPath path(random, pressing(1.01 * full, 0.03, -0.02),
                          scale_between(random, 0.2, 3.0) * wave * Vec3(1, 1, 0), 0.0);
    Asked asked(std::move(spec));
    double sum = 0.0, moved = 0.0;
    Wrench last;
    Pose before;
    for (int n = 0; n <= 6000; ++n) {
      const Pose pose = path.at(n / 6000.0);
      const Wrench wrench = asked.at(pose, {plane(pose)}).wrench;
      const double step = n > 0 ? work(last, wrench, before, pose) : 0.0;
      sum += step, moved += std::abs(step), last = wrench, before = pose;
    }
    EXPECT_LE(std::abs(sum), 1e-4 * moved) << attempt;
  }
}

TEST(Texture, EnergyPerMetreIsBounded) {
  std::mt19937_64 random(78);
  double highest = 0.0;
  for (int attempt = 0; attempt < 220; ++attempt) {
    effects::EffectSpec spec = any_texture(random);
    const double bound = effects::bound_of(spec).energy_per_metre_j, wave = spec.values.number(1);
    const BallTool tool{
        0.02 * Vec3(between(random, -1, 1), between(random, -1, 1), between(random, -1, 1)), 0.01};
    const ClosedPath path(random, {Vec3(0, 0, 0.009) - tool.centre, Quat::Identity()},
                          Vec3(wave, wave, 5e-4), between(random, 0, 0.2));
    Asked asked(std::move(spec));
    double sum = 0.0, displacement = 0.0;
    Wrench last;
    Pose before;
    for (int n = 0; n <= 3000; ++n) {
      const Pose pose = path.at(n / 3000.0);
      const std::vector<contact::ContactResult> contacts = {
          on_plane(pose, tool, kUp, 0, 800), on_ball(pose, tool, Vec3(0.015, 0, 0), 0.012, 1500)};
      const Wrench wrench = asked.at(pose, contacts).wrench;
      ASSERT_LE(wrench.force.norm(), bound * (1 + 1e-12));
      if (n > 0) {
        sum += work(last, wrench, before, pose);
        const Eigen::AngleAxisd turn(pose.orientation * before.orientation.conjugate());
        displacement +=
            (pose.position - before.position).norm() + turn.angle() * tool.centre.norm();
        ASSERT_LE(sum, bound * displacement + 1e-12) << attempt;
      }
      last = wrench, before = pose;
    }
    highest = std::max(highest, sum / (bound * displacement));
  }
  EXPECT_GT(highest, 1e-4) << "some are given energy: that is why the kind is called bounded";
  EXPECT_EQ(effects::find_effect_kind("texture")->energy, effects::EnergyBehaviour::kBounded);
}

TEST(Texture, DownhillPressureGainsAtMostTheBound) {
  Asked asked(texture(kGrating, 0.004, 0.5));
  double sum = 0.0, displacement = 0.0;
  Wrench last;
  Pose before;
  for (int n = 0; n <= 4000; ++n) {  // down a ridge pressed, up again in the air
    const double t = n / 4000.0, x = 0.001 + 0.002 * (t < 0.5 ? 2 * t : 2 - 2 * t);
    const Pose pose = pressing(t < 0.5 ? 1.0 : 0.0, x);
    const Wrench wrench = asked.at(pose, {plane(pose)}).wrench;
    if (n > 0 && n != 2000)
      sum += work(last, wrench, before, pose);
    if (n > 0)
      displacement += std::abs(x - before.position.x());
    last = wrench, before = pose;
  }
  EXPECT_NEAR(sum, 0.5 * 0.004 / M_PI, 1e-5);
  EXPECT_LT(sum, 0.5 * displacement);
}

TEST(Texture, HasNoForceStepWithinItsReportedStiffness) {
  std::mt19937_64 random(6);
  for (int attempt = 0; attempt < 40; ++attempt) {
    Asked asked(any_texture(random));
    double bound_before = 0.0;
    Vec3 last = Vec3::Zero();
    Pose before;
    for (int n = 0; n <= 10000; ++n) {
      const double t = n / 10000.0;
      const Pose pose{Vec3(0.02 * t, 0.013 * t, 0.011 - 0.012 * t * (1 - t)), Quat::Identity()};
      const effects::EffectForce push = asked.at(pose, {plane(pose)});
      ASSERT_GE(least_eigenvalue(push.stiffness), -1e-9 * push.stiffness.norm());
      if (n > 0) {
        ASSERT_LE((push.wrench.force - last).norm(),
                  std::max(bound_before, push.stiffness_bound_n_per_m) *
                          (pose.position - before.position).norm() * (1 + 1e-6) +
                      1e-12)
            << attempt << " " << n;
      }
      bound_before = push.stiffness_bound_n_per_m, last = push.wrench.force, before = pose;
    }
  }
}

TEST(Texture, ChangesItsRidgesWithoutAForceStepFarFromTheOrigin) {
  Asked asked(texture(kGrating, 0.002, 1.0));
  const Pose pose = pressing(2.0, 7.3);
  const double first = asked.at(pose, {plane(pose)}).wrench.force.x();
  double last = first, least = 1.0;
  EXPECT_EQ(set_value(asked.chain, "wavelength_m", {0.0013, 0, 0}), "");
  for (int n = 0; n < 400; ++n) {
    const double force = asked.at(pose, {plane(pose)}).wrench.force.x();
    EXPECT_LE(std::abs(force - last), 0.021) << n;
    last = force, least = std::min(least, std::abs(force));
  }
  EXPECT_EQ(least, 0.0);
  EXPECT_NEAR(last, -std::cos(2 * M_PI * 7.3 / 0.0013), 1e-9);
}

TEST(Texture, DependsOnPlaceOnly) {
  for (const int pattern : {kGrating, kNoise}) {
    Asked wandering(texture(pattern, 0.003, 1.0)), fresh(texture(pattern, 0.003, 1.0));
    std::mt19937_64 random(12);
    const ClosedPath path(random, pressing(3.0, 0.01), Vec3(5e-3, 5e-3, 1e-3), 0.0);
    for (int n = 0; n <= 700; ++n)
      wandering.at(path.at(n / 1000.0), {plane(path.at(n / 1000.0))});
    const Pose place = path.at(0.7);
    const std::vector<contact::ContactResult> there = {plane(place)};
    EXPECT_EQ(wandering.at(place, there).wrench.force, fresh.at(place, there).wrench.force);
  }
}

TEST(Texture, OfSeveralObjectsSumsInAnyOrderToNoMoreThanItsForce) {
  std::mt19937_64 random(3);
  Asked asked(texture(kNoise, 0.003, 1.0));
  for (int n = 0; n < 500; ++n) {
    const Pose pose{Vec3(between(random, 0.007, 0.011), between(random, 0.007, 0.011),
                         between(random, 0.007, 0.011)),
                    Quat::Identity()};
    const contact::ContactResult a = on_plane(pose, kBall, Vec3::UnitX(), 0, 800),
                                 b = on_plane(pose, kBall, Vec3::UnitY(), 0, 900),
                                 c = on_plane(pose, kBall, kUp, 0, 500);
    const Vec3 forward = asked.at(pose, {a, b, c}).wrench.force,
               back = asked.at(pose, {c, a, b}).wrench.force;
    EXPECT_LT((forward - back).norm(), 1e-14);
    EXPECT_LE(forward.norm(), 1 + 1e-12);
  }
}

TEST(Texture, ActsAtTheContactCentreWithinItsReach) {
  const BallTool tool{Vec3(0, 0.05, 0), 0.01};
  const Pose pose{Vec3(0, 0, 0.008), Quat::Identity()};
  for (const double reach : {0.02, 0.2}) {
    effects::EffectSpec spec = texture(kGrating, 0.004, 0.3);
    spec.values.at(5)[0] = reach;
    const Wrench wrench =
        Asked(std::move(spec)).at(pose, {on_plane(pose, tool, kUp, 0, 1000)}).wrench;
    EXPECT_NEAR(wrench.force.x(), -0.3, 1e-9);
    EXPECT_NEAR(wrench.torque.z(), 0.3 * std::min(reach, 0.05), 1e-9);
  }
}

}  // namespace texture_test
}  // namespace voxtouch::test
