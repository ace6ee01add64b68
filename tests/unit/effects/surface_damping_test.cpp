#include "tests/unit/effects/touch_support.hpp"

namespace voxtouch::test {
namespace surface_damping_test {

const BallTool kBall;
const Vec3 kUp = Vec3::UnitZ();

Pose pressing(double force_n) { return {Vec3(0, 0, 0.01 - force_n / 1000.0), Quat::Identity()}; }
contact::ContactResult plane(const Pose& pose) { return on_plane(pose, kBall, kUp, 0, 1000); }

TEST(SurfaceDamping, HasItsViscosityAlongAndAcrossTheSurface) {
  Asked asked(
      effect("surface_damping",
             {{"damping_ns_per_m", {4}}, {"normal_damping_ns_per_m", {2}}, {"full_force_n", {1}}}));
  const Twist twist{Vec3(0.1, -0.05, 0.2), Vec3(0, 5, 0)};
  const Pose pose = pressing(1.5);
  const effects::EffectForce push = asked.at(pose, {plane(pose)}, twist);
  const Vec3 expected(-4 * (0.1 - 0.05), 4 * 0.05,
                      -2 * 0.2);  // the lowest point moves back by 5 rad/s times 10 mm
  EXPECT_TRUE(push.wrench.force.isApprox(expected, 1e-9)) << push.wrench.force.transpose();
  EXPECT_TRUE(push.wrench.torque.isApprox(Vec3(0, 0, -0.01).cross(expected), 1e-9));
}

TEST(SurfaceDamping, GrowsWithTheContactForce) {
  Asked asked(effect("surface_damping", {{"damping_ns_per_m", {4}}, {"full_force_n", {1}}}));
  const Twist twist{Vec3(0.1, 0, 0), Vec3::Zero()};
  double last = 0.0;
  for (int n = 0; n <= 3000; ++n) {
    const Pose pose = pressing(-1.0 + 1e-3 * n);
    const double force = -asked.at(pose, {plane(pose)}, twist).wrench.force.x();
    EXPECT_GE(force, last - 1e-15);
    EXPECT_LE(force - last, 0.4 * 1.5e-3 * (1 + 1e-9)) << "a step";
    if (n <= 1000) {
      EXPECT_EQ(force, 0.0) << "in free space";
    }
    if (n >= 2000) {
      EXPECT_NEAR(force, 0.4, 1e-12);
    }
    last = force;
  }
}

TEST(SurfaceDamping, IsAgainstTheObjectsOwnMotion) {
  Asked asked(effect("surface_damping", {{"damping_ns_per_m", {4}}}));
  const Twist belt{Vec3(0.1, 0.2, 0), Vec3(0, 0, 2)};
  const Pose pose = pressing(2.0);
  EXPECT_LT(asked.at(pose, {plane(pose)}, belt, {belt}).wrench.force.norm(), 1e-15);
  EXPECT_TRUE(
      asked.at(pose, {plane(pose)}, {}, {belt}).wrench.force.isApprox(Vec3(0.4, 0.8, 0), 1e-9));
}

TEST(SurfaceDamping, TakesEnergyAtEveryMomentWithinItsBound) {
  std::mt19937_64 random(31);
  const auto any = [&] {
    return Vec3(between(random, -1, 1), between(random, -1, 1), between(random, -1, 1));
  };
  for (int attempt = 0; attempt < 300; ++attempt) {
    Asked asked(effect("surface_damping", {{"damping_ns_per_m", {between(random, 0, 100)}},
                                           {"normal_damping_ns_per_m", {between(random, 0, 100)}},
                                           {"full_force_n", {scale_between(random, 0.01, 10)}},
                                           {"reach_m", {scale_between(random, 0.001, 1)}}}));
    const effects::EffectBound bound = effects::bound_of(asked.chain.spec(0));
    const BallTool tool{0.03 * any(), 0.01};
    for (int n = 0; n < 50; ++n) {
      const Pose pose{Vec3(0, 0, 0.009) - tool.centre + 0.001 * any(), Quat::Identity()};
      const Twist twist{0.3 * any(), 5 * any()};
      std::vector<contact::ContactResult> contacts = {
          on_plane(pose, tool, kUp, 0, 800), on_ball(pose, tool, Vec3(0.015, 0, 0), 0.012, 1500),
          on_plane(pose, tool, Vec3(0, 0.6, 0.8), 0, 300)};
      const effects::EffectForce push = asked.at(pose, contacts, twist);
      ASSERT_LE(push.wrench.force.dot(twist.linear) + push.wrench.torque.dot(twist.angular), 1e-12)
          << attempt;
      const double fastest =
          twist.linear.norm() + asked.chain.spec(0).values.number(3) * twist.angular.norm();
      ASSERT_LE(push.wrench.force.norm(), bound.damping_ns_per_m * fastest * (1 + 1e-12));
      ASSERT_GE(least_eigenvalue(push.stiffness), -1e-9 * push.stiffness.norm());
      std::swap(contacts[0], contacts[2]);
      const effects::EffectForce again = Asked(asked.chain.spec(0)).at(pose, contacts, twist);
      if (n == 0) {
        ASSERT_LT((again.wrench.force - push.wrench.force).norm(), 1e-12) << "order of the objects";
      }
    }
  }
}

TEST(SurfaceDamping, StiffnessCoversItsChangeWithDepth) {
  Asked asked(effect("surface_damping", {{"damping_ns_per_m", {20}}, {"full_force_n", {2}}}));
  const Twist twist{Vec3(0.3, 0.1, 0), Vec3::Zero()};
  Vec3 last = Vec3::Zero();
  for (int n = 0; n < 3000; ++n) {
    const Pose pose = pressing(1e-3 * n);
    const effects::EffectForce push = asked.at(pose, {plane(pose)}, twist);
    if (n > 0) {
      EXPECT_LE((push.wrench.force - last).norm(),
                push.stiffness_bound_n_per_m * 1e-6 * (1 + 1e-9));
    }
    last = push.wrench.force;
  }
}

}  // namespace surface_damping_test
}  // namespace voxtouch::test
