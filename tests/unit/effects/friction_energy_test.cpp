// Energy, timing and noise of friction.
#include <algorithm>

#include "tests/unit/effects/touch_support.hpp"

namespace voxtouch::test {
namespace {

const Vec3 kUp = Vec3::UnitZ();

effects::EffectSpec any_friction(std::mt19937_64& random) {
  return effect("friction", {{"coulomb", {between(random, 0.0, 2.0)}},
                             {"sticking", {between(random, 1.0, 2.0)}},
                             {"stiffness_n_per_m", {scale_between(random, 10, 5000)}},
                             {"most_n", {scale_between(random, 0.1, 200)}},
                             {"reach_m", {scale_between(random, 0.005, 1.0)}}});
}

struct Given {
  double end_j = 0.0, most_j = 0.0;  ///< after the whole path; largest at any time on it
  double moved_j = 0.0;              ///< sum of all |work|: the scale for the others
};

/// The effect's work on a closed path of `samples`, traversed twice, against a resting plane and
/// ball.
Given given_on(const ClosedPath& path, effects::EffectSpec spec, const BallTool& tool,
               int samples) {
  Asked asked(std::move(spec));
  Given given;
  Wrench last;
  Pose before = path.at(0.0);
  for (int n = 0; n <= 2 * samples; ++n) {
    const Pose pose = path.at(static_cast<double>(n) / samples);
    const Wrench wrench = asked
                              .at(pose, {on_plane(pose, tool, kUp, 0, 800),
                                         on_ball(pose, tool, Vec3(0.015, 0, 0), 0.012, 1500)})
                              .wrench;
    EXPECT_TRUE(wrench.finite());
    if (n > 0) {
      const double step = work(last, wrench, before, pose);
      given.end_j += step, given.moved_j += std::abs(step);
      given.most_j = std::max(given.most_j, given.end_j);
    }
    last = wrench, before = pose;
  }
  return given;
}

TEST(Friction, GivesNoEnergyOnAnyOf240RandomClosedPaths) {
  std::mt19937_64 random(20260101);
  int rubbed = 0;
  for (int attempt = 0; attempt < 240; ++attempt) {
    const BallTool tool{
        0.02 * Vec3(between(random, -1, 1), between(random, -1, 1), between(random, -1, 1)), 0.01};
    const double size = scale_between(random, 1e-4, 1e-2);
    const ClosedPath path(random, {Vec3(0, 0, 0.0085) - tool.centre, Quat::Identity()},
                          size * Vec3(1, 1, 0.3), attempt % 3 == 0 ? 0.0 : between(random, 0, 0.4));
    const Given given = given_on(path, any_friction(random), tool, 4000);
    EXPECT_LE(given.end_j, 2e-4 * given.moved_j) << attempt;
    EXPECT_LE(given.most_j, 1e-3 * given.moved_j) << attempt;
    rubbed += given.end_j < -0.1 * given.moved_j ? 1 : 0;
  }
  EXPECT_GT(rubbed, 100);
}

/// The bristles bend at the rim with little friction, are carried in within their reach, released
/// inside, and leave unbent: a force scaled by the region would return larger.
TEST(Friction, GivesNoEnergyAtTheRimOfARegion) {
  for (const double blend : {1e-5, 1e-4, 1e-3}) {
    effects::EffectSpec spec =
        effect("friction", {{"coulomb", {1.0}}, {"stiffness_n_per_m", {300}}});
    spec.region = {.shape = effects::BoxRegion{.pose = {}, .size_m = Vec3(0.02, 1.0, 1.0)},
                   .blend_m = blend};  // its face at x = 10 mm
    Asked asked(std::move(spec));
    const BallTool tool;
    const double rim = 0.010 + 0.9 * blend, inside = 0.010, bend = 5e-4;
    const Vec3 corners[] = {{rim, 0, 0}, {rim, bend, 0}, {inside, bend, 0}, {inside, 0, 0}};
    double given = 0.0, moved = 0.0;
    Wrench last;
    Pose before;
    for (int loop = 0; loop < 5; ++loop)
      for (int side = 0; side < 4; ++side)
        for (int n = 0; n < 500; ++n) {
          const Vec3 at = corners[side] + n / 500.0 * (corners[(side + 1) % 4] - corners[side]);
          const Pose pose{at + Vec3(0, 0, 0.009), Quat::Identity()};
          const Wrench wrench = asked.at(pose, {on_plane(pose, tool, kUp, 0, 1000)}).wrench;
          if (loop + side + n > 0)
            given += work(last, wrench, before, pose),
                moved += std::abs(work(last, wrench, before, pose));
          last = wrench, before = pose;
        }
    EXPECT_LE(given, 1e-3 * moved) << "blend " << blend;
    EXPECT_GT(moved, 1e-5) << "it was displayed";
  }
}

TEST(Friction, HoldsAToolOnASlopeWithoutCreep) {
  constexpr double kMass = 0.1, kWall = 1000.0, kDamping = 2.0, kStep = 2e-5, kDt = 1e-3,
                   kGravity = 9.81;
  const Vec3 up =
      Eigen::AngleAxisd(0.3, Vec3::UnitX()) * Vec3::UnitZ();  // tan 0.3 = 0.31 of a cone of 0.5
  const BallTool tool;
  Asked asked(effect("friction", {{"coulomb", {0.5}}}));
  std::mt19937_64 random(8);
  std::uniform_int_distribution<int> dither(-1, 1);
  Vec3 x = (tool.radius_m - kMass * kGravity * std::cos(0.3) / kWall) * up, v = Vec3::Zero();
  Vec3 early = Vec3::Zero(), late = Vec3::Zero();
  double least = 1e9, most = 0.0;
  for (int n = 0; n < 60000; ++n) {
    Pose seen;
    for (int a = 0; a < 3; ++a)
      seen.position[a] = kStep * (std::round(x[a] / kStep) + dither(random));
    const contact::ContactResult contact = on_plane(seen, tool, up, 0, kWall);
    const effects::EffectForce push = asked.at(seen, {contact});
    const Vec3 force =
        contact.wrench.force + push.wrench.force - kMass * kGravity * Vec3::UnitZ() - kDamping * v;
    v += kDt / kMass * force, x += kDt * v;
    if (n >= 1000 && n < 6000)
      early += x / 5000.0;
    if (n >= 55000)
      late += x / 5000.0;
    if (n >= 1000)
      least = std::min(least, push.wrench.force.norm()),
      most = std::max(most, push.wrench.force.norm());
  }
  EXPECT_LT((late - early).norm(), 0.2 * kStep) << "crept";
  EXPECT_NEAR(0.5 * (least + most), kMass * kGravity * std::sin(0.3), 0.02);
  EXPECT_LT(most - least, 300.0 * 6.0 * kStep)
      << "no more than the bristles make of the noise itself";
}

TEST(Friction, IsConstantForAToolAtRest) {
  std::mt19937_64 random(4);
  for (int attempt = 0; attempt < 50; ++attempt) {
    Asked asked(any_friction(random));
    const BallTool tool{Vec3(0.01, 0.02, -0.01), 0.01};
    const ClosedPath path(random, {Vec3(0, 0, 0.0085) - tool.centre, Quat::Identity()},
                          Vec3(2e-3, 2e-3, 5e-4), 0.3);
    for (int n = 0; n < 300; ++n)
      asked.at(path.at(n / 400.0), {on_plane(path.at(n / 400.0), tool, kUp, 0, 800)});
    const Pose rest = path.at(0.75);
    const std::vector<contact::ContactResult> contact = {on_plane(rest, tool, kUp, 0, 800)};
    const Vec3 first = asked.at(rest, contact).wrench.force;
    for (int n = 0; n < 100; ++n)
      ASSERT_LT((asked.at(rest, contact).wrench.force - first).norm(), 1e-14) << attempt;
  }
}

TEST(Friction, HasNoForceStepInAlongAndOut) {
  std::mt19937_64 random(9);
  for (int attempt = 0; attempt < 40; ++attempt) {
    Asked asked(any_friction(random));
    const double heading = between(random, 0, 2 * M_PI);
    const Vec3 along(std::cos(heading), std::sin(heading), 0);
    Vec3 last = Vec3::Zero();
    Pose before;
    effects::EffectForce push;
    for (int n = 0; n <= 20000; ++n) {  // a parabola of 2 mm depth over 20 mm, there and back again
      const double s = n / 10000.0, t = s <= 1.0 ? s : 2.0 - s;
      const Pose pose{0.02 * t * along + Vec3(0, 0, 0.011 - 0.012 * t * (1 - t)), Quat::Identity()};
      const contact::ContactResult contact = on_plane(pose, BallTool{}, kUp, 0, 800);
      const double bound_before = push.stiffness_bound_n_per_m;
      push = asked.at(pose, {contact});
      const double bound = std::max(bound_before, push.stiffness_bound_n_per_m);
      if (n > 0) {
        ASSERT_LE((push.wrench.force - last).norm(),
                  bound * (pose.position - before.position).norm() * (1 + 1e-9) + 1e-12)
            << attempt << " " << n;
      }
      last = push.wrench.force, before = pose;
    }
  }
}

TEST(Friction, DeepestPointJumpGivesNoTorqueStep) {
  Asked asked(effect("friction", {{"coulomb", {1.0}}}));
  double largest = 0.0;
  Vec3 last = Vec3::Zero();
  for (int n = 0; n < 4000; ++n) {
    const Pose pose{Vec3(1e-6 * n, 0, 0.009), Quat::Identity()};
    contact::ContactResult contact = on_plane(pose, BallTool{}, kUp, 0, 1000);
    if (n / 100 % 2 == 1)
      contact.deepest_point.z() += 0.004;
    const Vec3 torque = asked.at(pose, {contact}).wrench.torque;
    largest = std::max(largest, (torque - last).norm());
    last = torque;
  }
  EXPECT_LT(largest,
            1e-6 * (300 * 0.01 + 1.0) *
                1.01);  // k times arm of a step, and the force times a step of the height
}

TEST(Friction, StaysFiniteForInvalidContacts) {
  Asked asked(
      effect("friction", {{"coulomb", {2.0}}, {"sticking", {2.0}}, {"stiffness_n_per_m", {5000}}}));
  std::mt19937_64 random(2);
  for (int n = 0; n < 5000; ++n) {
    contact::ContactResult contact;
    contact.wrench.force = std::pow(10.0, between(random, -300, 100)) * Vec3::Random();
    contact.wrench.torque = std::pow(10.0, between(random, -300, 100)) * Vec3::Random();
    contact.deepest_point = std::pow(10.0, between(random, -10, 10)) * Vec3::Random();
    const Pose pose{std::pow(10.0, between(random, -10, 10)) * Vec3::Random(),
                    Quat(Eigen::Vector4d::Random()).normalized()};
    const effects::EffectForce push = asked.at(pose, {contact, contact});
    ASSERT_TRUE(push.wrench.finite() && push.stiffness.allFinite());
    ASSERT_LE(push.wrench.force.norm(), 2 * 20.0 * (1 + 1e-9));
  }
  EXPECT_EQ(asked.chain.not_finite(), 0u);
}

}  // namespace
}  // namespace voxtouch::test
