// The friction's law against its closed form.
#include <algorithm>

#include "tests/unit/effects/chain_change.hpp"
#include "tests/unit/effects/touch_support.hpp"

namespace voxtouch::test {
namespace friction_test {

const BallTool kBall;
constexpr double kWall = 1000.0;  // N/m of the object
const Vec3 kUp = Vec3::UnitZ();

/// Presses with `force_n` at `x`, `y`.
Pose pressing(double force_n, double x, double y = 0.0) {
  return {Vec3(x, y, kBall.radius_m - force_n / kWall), Quat::Identity()};
}

effects::EffectForce slide_to(Asked& asked, const Pose& pose) {
  return asked.at(pose, {on_plane(pose, kBall, kUp, 0, kWall)});
}

TEST(Friction, IsASpringWithinTheConeAndTheConeBeyond) {
  Asked asked(effect("friction", {{"coulomb", {0.5}}, {"stiffness_n_per_m", {400}}}));
  for (int n = 0; n <= 1000; ++n) {
    const double x = 1e-5 * n;
    const effects::EffectForce push = slide_to(asked, pressing(2.0, x));
    EXPECT_NEAR(push.wrench.force.x(), -std::min(400 * x, 0.5 * 2.0), 1e-9);
    EXPECT_NEAR(push.wrench.torque.y(), 0.01 * std::min(400 * x, 1.0), 1e-9);
  }
  for (int n = 0; n <= 1000;
       ++n) {  // and back: 5 mm of path from one side of the cone to the other
    const effects::EffectForce push = slide_to(asked, pressing(2.0, 0.01 - 1e-5 * n));
    EXPECT_NEAR(push.wrench.force.x(), -1.0 + std::min(400 * 1e-5 * n, 2.0), 1e-9);
  }
}

TEST(Friction, OpposesTheSlidingDirectionInTheTangentPlane) {
  Asked asked(effect("friction", {{"coulomb", {0.3}}}));
  const double heading = 0.7;
  Wrench last;
  for (int n = 0; n < 3000; ++n)
    last = slide_to(asked, pressing(1.0, 1e-5 * n, 0)).wrench;
  for (int n = 0; n < 3000; ++n)
    last = slide_to(asked, pressing(1.0, 0.03 + 1e-5 * n * std::cos(heading),
                                    1e-5 * n * std::sin(heading)))
               .wrench;
  EXPECT_TRUE(last.force.isApprox(-0.3 * Vec3(std::cos(heading), std::sin(heading), 0), 1e-6))
      << last.force.transpose();
}

TEST(Friction, SticksByItsFactorAndReleasesWithoutAStep) {
  Asked asked(
      effect("friction", {{"coulomb", {0.4}}, {"sticking", {1.5}}, {"stiffness_n_per_m", {500}}}));
  double most = 0.0, last = 0.0;
  for (int n = 0; n <= 6000; ++n) {
    const double force = -slide_to(asked, pressing(2.0, 1e-6 * n)).wrench.force.x();
    EXPECT_LE(std::abs(force - last), 500 * 1e-6 * (1 + 1e-6)) << n;
    most = std::max(most, last = force);
  }
  EXPECT_NEAR(most, 1.5 * 0.4 * 2.0, 5e-4);
  EXPECT_NEAR(last, 0.4 * 2.0, 1e-9);
  EXPECT_NEAR(-slide_to(asked, pressing(2.0, 0.006)).wrench.force.x(), last, 0.0)
      << "nothing moves, nothing changes";
  for (int n = 1; n <= 4000; ++n)
    most = -slide_to(asked, pressing(2.0, 0.006 - 1e-6 * n)).wrench.force.x();
  EXPECT_NEAR(most, -1.2, 1e-9) << "mended on the way to the other side";
}

TEST(Friction, ReleasesIndependentlyOfTheStepLength) {
  const auto force_after = [](double displacement, int steps) {
    Asked asked(effect("friction",
                       {{"coulomb", {0.4}}, {"sticking", {1.5}}, {"stiffness_n_per_m", {500}}}));
    double force = 0.0;
    for (int n = 0; n <= steps; ++n)
      force = -slide_to(asked, pressing(2.0, displacement * n / steps)).wrench.force.x();
    return force;
  };
  for (const double displacement : {0.001, 0.0024, 0.0026, 0.0028, 0.003, 0.0034, 0.01})
    EXPECT_NEAR(force_after(displacement, 1), force_after(displacement, 1000), 1e-9)
        << displacement;
}

TEST(Friction, NeverExceedsTheScenesCap) {
  Asked asked(effect("friction", {{"coulomb", {1.0}}, {"most_n", {0.8}}}));
  double most = 0.0;
  for (int n = 0; n < 2000; ++n)
    most = std::max(most, slide_to(asked, pressing(5.0, 1e-5 * n)).wrench.force.norm());
  EXPECT_NEAR(most, 0.8, 1e-9);
  EXPECT_EQ(effects::bound_of(asked.chain.spec(0)).force_n, 0.8);
}

TEST(Friction, LowerPressureSlipsAndHigherDoesNotBend) {
  Asked asked(effect("friction", {{"coulomb", {0.5}}, {"stiffness_n_per_m", {500}}}));
  slide_to(asked, pressing(2.0, 0));
  EXPECT_NEAR(slide_to(asked, pressing(2.0, 0.0018)).wrench.force.x(), -0.9, 1e-12);
  EXPECT_NEAR(slide_to(asked, pressing(4.0, 0.0018)).wrench.force.x(), -0.9, 1e-12);
  EXPECT_NEAR(slide_to(asked, pressing(1.0, 0.0018)).wrench.force.x(), -0.5, 1e-12);
  EXPECT_NEAR(slide_to(asked, pressing(4.0, 0.0018)).wrench.force.x(), -0.5, 1e-12);
  const Pose off{Vec3(0.0018, 0, 0.02), Quat::Identity()};
  EXPECT_TRUE(slide_to(asked, off).wrench.zero());
  EXPECT_TRUE(slide_to(asked, pressing(4.0, 0.0018)).wrench.zero())
      << "what was before the lift is forgotten";
}

TEST(Friction, OfASpinningBallActsAtItsDeepestPoint) {
  Asked asked(effect("friction", {{"coulomb", {0.5}}, {"stiffness_n_per_m", {400}}}));
  effects::EffectForce push;
  for (int n = 0; n <= 100; ++n) {
    Pose pose = pressing(2.0, 0);
    pose.orientation = Quat(Eigen::AngleAxisd(1e-3 * n, Vec3::UnitY()));
    push = slide_to(asked, pose);
  }
  const double displacement =
      0.1 * 0.01;  // the lowest point of a ball rotated by 0.1 rad about y moved this far along -x
  EXPECT_NEAR(push.wrench.force.x(), 400 * displacement, 2e-3);
  EXPECT_NEAR(push.wrench.torque.y(), -0.01 * 400 * displacement, 2e-5);
}

TEST(Friction, OfAnOffsetContactActsAtTheContact) {
  const BallTool tool{Vec3(0.05, 0, 0), 0.01};
  Asked asked(effect("friction", {{"coulomb", {0.5}}, {"stiffness_n_per_m", {400}}}));
  effects::EffectForce push;
  for (int n = 0; n <= 10; ++n) {
    const Pose pose{Vec3(0, 1e-4 * n, 0.008), Quat::Identity()};
    push = asked.at(pose, {on_plane(pose, tool, kUp, 0, kWall)});
  }
  EXPECT_NEAR(push.wrench.force.y(), -0.4, 1e-12);
  EXPECT_TRUE(push.wrench.torque.isApprox(Vec3(0.05, 0, -0.01).cross(push.wrench.force), 1e-9));
}

TEST(Friction, IsAgainstTheObjectsOwnMotion) {
  Asked carried(effect("friction", {{"coulomb", {0.5}}})),
      dragged(effect("friction", {{"coulomb", {0.5}}}));
  const Twist belt{Vec3(0.1, 0, 0), Vec3::Zero()};
  effects::EffectForce push;
  for (int n = 0; n < 100; ++n) {  // the tool moves with the belt: no sliding
    const Pose pose = pressing(1.0, 1e-4 * n);
    EXPECT_NEAR(
        carried.at(pose, {on_plane(pose, kBall, kUp, 0, kWall)}, {}, {belt}).wrench.force.norm(),
        0.0, 1e-12);
    const Pose still = pressing(1.0, 0);
    push = dragged.at(still, {on_plane(still, kBall, kUp, 0, kWall)}, {}, {belt});
  }
  EXPECT_TRUE(push.wrench.force.isApprox(Vec3(0.5, 0, 0), 1e-9));
  // A tool that sticks to a rotating object rotates with it.
  Asked asked(effect("friction", {{"coulomb", {0.5}}, {"stiffness_n_per_m", {400}}}));
  asked.at(pressing(2.0, 0), {on_plane(pressing(2.0, 0), kBall, kUp, 0, kWall)});
  const Vec3 before =
      asked.at(pressing(2.0, 1e-3), {on_plane(pressing(2.0, 1e-3), kBall, kUp, 0, kWall)})
          .wrench.force;
  const Twist spin{Vec3::Zero(), Vec3(0, 0, 100)};
  Pose pose = pressing(2.0, 1e-3);
  pose.orientation = Quat(Eigen::AngleAxisd(0.1, Vec3::UnitZ()));
  const Vec3 after =
      asked.at(pose, {on_plane(pose, kBall, kUp, 0, kWall)}, {}, {spin}).wrench.force;
  EXPECT_TRUE(after.isApprox(Eigen::AngleAxisd(0.1, Vec3::UnitZ()) * before, 1e-9));
}

TEST(Friction, KeepsItsBendTangentialAroundACorner) {
  const Vec3 middle = Vec3::Zero();
  Asked asked(effect("friction", {{"coulomb", {2.0}}, {"stiffness_n_per_m", {100}}}));
  double last = 0.0;
  for (int n = 0; n <= 900;
       ++n) {  // pulled 1 mm along y, then carried round a ball in x and z: the pull stays as long
    const double angle = 1e-3 * std::max(0, n - 100), y = 1e-5 * std::min(n, 100);
    const Pose pose{0.019 * Vec3(std::sin(angle), 0, std::cos(angle)) + Vec3(0, y, 0),
                    Quat::Identity()};
    const contact::ContactResult contact = on_ball(pose, kBall, middle + Vec3(0, y, 0), 0.01, 5000);
    const Wrench wrench = asked.at(pose, {contact}).wrench;
    EXPECT_NEAR(wrench.force.dot(contact.mean_normal), 0.0, 1e-12);
    EXPECT_NEAR(wrench.force.y(), -100 * y, 1e-12);
    last = wrench.force.norm();
  }
  EXPECT_GT(last, 0.1);
}

TEST(Friction, KeepsItsSizeWhenTheNormalRotates) {
  Asked asked(effect("friction", {{"coulomb", {2.0}}, {"stiffness_n_per_m", {100}}}));
  const Pose pose = pressing(2.0, 1e-3, 5e-4);
  slide_to(asked, pressing(2.0, 0));
  const Vec3 before = slide_to(asked, pose).wrench.force;
  ASSERT_GT(before.norm(), 0.1);
  for (const double angle : {0.1, 0.4, 0.2, -0.5}) {
    const Vec3 normal(std::sin(angle), 0, std::cos(angle));
    const Vec3 turned = asked.at(pose, {pushed(pose, kBall, normal, 0.002, kWall)}).wrench.force;
    EXPECT_NEAR(turned.norm(), before.norm(), 1e-12);
    EXPECT_NEAR(turned.dot(normal), 0.0, 1e-12);
    EXPECT_TRUE(turned.isApprox(Eigen::AngleAxisd(angle, Vec3::UnitY()) * before, 1e-9));
  }
}

TEST(Friction, SumsOverObjectsInAnyOrderAndKeepsThemApart) {
  const Vec3 normals[3] = {Vec3::UnitZ(), Vec3(0, 0.6, 0.8), Vec3(1, 0, 0)};
  std::mt19937_64 random(5);
  Asked forward(effect("friction", {{"coulomb", {0.7}}, {"sticking", {1.3}}}));
  Asked shuffled(forward.chain.spec(0));
  std::vector<Asked> alone;
  for (int n = 0; n < 3; ++n)
    alone.emplace_back(forward.chain.spec(0));
  const ClosedPath path(random, {Vec3(0.009, 0.009, 0.009), Quat::Identity()},
                        Vec3(2e-3, 2e-3, 2e-3), 0.2);
  for (int n = 0; n <= 2000; ++n) {
    const Pose pose = path.at(n / 2000.0);
    std::vector<contact::ContactResult> contacts;
    for (const Vec3& normal : normals)
      contacts.push_back(on_plane(pose, kBall, normal, 0, kWall));
    std::vector<effects::ObjectContact> order = {
        {7, &contacts[0], {}}, {0, &contacts[1], {}}, {3, &contacts[2], {}}};
    Wrench sum;
    for (std::size_t a = 0; a < 3; ++a) {
      const Wrench one = alone[a].with(pose, std::span(&order[a], 1)).wrench;
      sum.force += one.force, sum.torque += one.torque;
    }
    const Wrench first = forward.with(pose, order).wrench;
    std::shuffle(order.begin(), order.end(), random);
    const Wrench second = shuffled.with(pose, order).wrench;
    ASSERT_LT((first.force - second.force).norm() + (first.torque - second.torque).norm(), 1e-12);
    ASSERT_LT((first.force - sum.force).norm() + (first.torque - sum.torque).norm(), 1e-12);
  }
}

TEST(Friction, LeavesOutExcessObjects) {
  Asked asked(effect("friction", {{"coulomb", {0.5}}, {"stiffness_n_per_m", {100}}}));
  double force = 0.0;
  for (int n = 0; n <= 10; ++n) {
    const Pose pose = pressing(2.0, 1e-4 * n);
    force =
        asked
            .at(pose, std::vector<contact::ContactResult>(20, on_plane(pose, kBall, kUp, 0, kWall)))
            .wrench.force.x();
  }
  EXPECT_NEAR(force, -16 * 0.1, 1e-12);
}

TEST(Friction, IsForgottenByAResetAndStartsFromNothing) {
  Asked asked(effect("friction", {{"coulomb", {0.5}}}));
  slide_to(asked, pressing(2.0, 0));
  EXPECT_GT(slide_to(asked, pressing(2.0, 0.001)).wrench.force.norm(), 0.1);
  asked.chain.reset();
  EXPECT_TRUE(slide_to(asked, pressing(2.0, 0.5)).wrench.zero());
}

TEST(Friction, StifferBristlesKeepTheForce) {
  Asked asked(effect("friction", {{"coulomb", {0.5}}, {"stiffness_n_per_m", {200}}}));
  slide_to(asked, pressing(2.0, 0));
  slide_to(asked, pressing(2.0, 0.001));
  set_value(asked.chain, "stiffness_n_per_m", {1000, 0, 0});
  for (int n = 0; n < 200; ++n)
    EXPECT_NEAR(slide_to(asked, pressing(2.0, 0.001)).wrench.force.x(), -0.2, 1e-9);
  EXPECT_NEAR(slide_to(asked, pressing(2.0, 0.0011)).wrench.force.x(), -0.3, 1e-9);
}

TEST(Friction, ReportsAtLeastItsOwnStiffness) {
  std::mt19937_64 random(11);
  for (int attempt = 0; attempt < 200; ++attempt) {
    const double k = scale_between(random, 10, 5000), wall = scale_between(random, 50, 3000);
    Asked asked(effect("friction", {{"coulomb", {between(random, 0, 2)}},
                                    {"sticking", {attempt % 2 ? 1.0 : between(random, 1, 2)}},
                                    {"stiffness_n_per_m", {k}},
                                    {"most_n", {200}}}));
    const BallTool tool{0.03 * Vec3::Random(), 0.01};
    Pose pose{-tool.centre + Vec3(0, 0, 0.01 - 1.0 / wall), Quat::Identity()};
    asked.at(pose, {on_plane(pose, tool, kUp, 0, wall)});
    pose.position.x() += scale_between(random, 1e-5, 1e-2);
    const effects::EffectForce before = asked.at(pose, {on_plane(pose, tool, kUp, 0, wall)});
    const Mat6& s = before.stiffness;
    EXPECT_LT((s - s.transpose()).norm(), 1e-12 * s.norm());
    EXPECT_GT(least_eigenvalue(s), -1e-9 * s.norm());
    EXPECT_LE(norm_of(s.topLeftCorner<3, 3>()), before.stiffness_bound_n_per_m * (1 + 1e-12));
    const Vec3 displacement = 1e-7 * Vec3::Random();
    pose.position += displacement;
    const effects::EffectForce after = asked.at(pose, {on_plane(pose, tool, kUp, 0, wall)});
    const Vec3 change = after.wrench.force - before.wrench.force;
    EXPECT_LE(change.norm(), before.stiffness_bound_n_per_m * displacement.norm() * (1 + 1e-3))
        << attempt;
    EXPECT_LE(-change.dot(displacement),
              displacement.dot(s.topLeftCorner<3, 3>() * displacement) * (1 + 1e-3) + 1e-18)
        << attempt;
  }
}

TEST(Friction, StiffnessCoversAReleaseUnderEasingForce) {
  const double wall = 3000, slides = 0.5, k = 100, force_n = 2.0;
  Asked asked(
      effect("friction", {{"coulomb", {slides}}, {"sticking", {1.5}}, {"stiffness_n_per_m", {k}}}));
  const auto contact = [&](const Pose& pose) {
    return std::vector{on_plane(pose, kBall, kUp, 0, wall)};
  };
  Pose pose{Vec3(0, 0, 0.01 - force_n / wall), Quat::Identity()};
  asked.at(pose, contact(pose));
  pose.position.x() = (1.5 * slides * force_n + 0.25 * slides * force_n) / k;  // half torn
  const effects::EffectForce before = asked.at(pose, contact(pose));
  ASSERT_GT(before.wrench.force.norm(), 1.1 * slides * force_n);
  ASSERT_LT(before.wrench.force.norm(), 1.4 * slides * force_n);
  pose.position.z() += 1e-7;
  const effects::EffectForce after = asked.at(pose, contact(pose));
  const double change = (after.wrench.force - before.wrench.force).norm() / 1e-7;
  EXPECT_LE(change, before.stiffness_bound_n_per_m);
  EXPECT_GT(change, 0.7 * before.stiffness_bound_n_per_m);
}

}  // namespace friction_test
}  // namespace voxtouch::test
