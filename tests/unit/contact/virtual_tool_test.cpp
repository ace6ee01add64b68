// The virtual tool against exact truths: the god-object of the exact ball on exact triangles,
// Coulomb's law, and its own promises.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>

#include "tests/experiments/virtual_tool/runs.hpp"
#include "tests/support/seed.hpp"

namespace voxtouch::virtual_tool {
namespace {

using test::degrees_between;

std::string reported(const PressFigures& f) {
  return "direction " + std::to_string(f.direction_median) + ", 95 % " +
         std::to_string(f.direction_95) + " degrees; size " + std::to_string(f.size_median) +
         "; rest " + std::to_string(f.rest_worst) + " N";
}

struct PressCase {
  const char* scene;
  bool turned;
  double direction_95, size;  ///< [degrees]; |F| over the truth's, less one
  double edge = 0.002;
};
void PrintTo(const PressCase& c, std::ostream* out) {
  *out << c.scene << (c.turned ? ", turned" : "");
}
class Press : public ::testing::TestWithParam<PressCase> {};

/// The facets of the ball lack 0.1 % of 10 mm.
TEST_P(Press, GivesTheForceOfTheExactGodObjectAndRests) {
  const std::uint64_t seed = testing::seed(11);
  SCOPED_TRACE(testing::seed_trace(seed));
  const PressFigures f = press({.scene = GetParam().scene,
                                .edge = GetParam().edge,
                                .places = 25,
                                .turned = GetParam().turned,
                                .seed = seed});
  std::printf("%s%s: %s\n", GetParam().scene, GetParam().turned ? ", turned" : "",
              reported(f).c_str());
  EXPECT_LT(f.direction_95, GetParam().direction_95);
  EXPECT_LT(std::abs(f.size_median), GetParam().size);
  EXPECT_LT(f.rest_worst, 1e-3);  // [N], from frame to frame
  EXPECT_LT(f.depth_worst, 0.02);
  EXPECT_LE(f.queries_most, 7);
}
INSTANTIATE_TEST_SUITE_P(
    Scenes, Press,
    ::testing::Values(
        PressCase{"plane", false, 0.001, 0.002}, PressCase{"plane", true, 0.001, 0.002},
        PressCase{"tilted", false, 0.001, 0.002}, PressCase{"tilted", true, 0.001, 0.002},
        PressCase{"cylinder", false, 3.0, 0.002}, PressCase{"cylinder", true, 2.5, 0.002},
        PressCase{"cup", false, 1.0, 0.002}, PressCase{"cup", true, 1.0, 0.002},
        PressCase{"plate:0.002", true, 0.001, 0.002}, PressCase{"plate:0.0005", true, 0.001, 0.002},
        PressCase{"plate:0.002:askew", true, 0.001, 0.002},
        PressCase{"plate:0.0005:askew", true, 0.001, 0.002},
        PressCase{"plate:0.0025:askew", true, 0.001, 0.002, 0.001}),
    [](const auto& one) {
      std::string name = one.param.scene;
      for (char& c : name)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0)
          c = '_';
      return name + (one.param.turned ? "_turned" : "");
    });

/// Only the ball's facets remain.
TEST(VirtualTool, DirectionOnRoundSurfacesHidesTheVoxels) {
  const PressFigures f =
      press({.scene = "cylinder:384", .places = 200, .turned = true, .seed = testing::seed(7)});
  std::printf("%s\n", reported(f).c_str());
  EXPECT_LT(f.direction_95, 1.75);
  EXPECT_LT(f.rest_worst, 1e-3);
}

/// The same for the force steps of a sliding tool: only the facets of ball and cylinder remain.
TEST(VirtualTool, ForceStepsOnACylinderHideTheVoxels) {
  const SlideFigures f = slide({.scene = "cylinder", .speed = 0.05, .seed = 1});
  std::printf("step over force %.4f\n", f.step_over_force);
  EXPECT_LT(f.step_over_force, 0.02);
}

/// Square onto a block's right angle.
TEST(VirtualTool, GivesTheForceOfTheExactGodObjectAtAConvexEdge) {
  const std::uint64_t seed = testing::seed(7);
  SCOPED_TRACE(testing::seed_trace(seed));
  for (const auto& [edge, depth, direction_95] : {std::tuple{0.002, 0.003, 2.0},
                                                  {0.002, 0.007, 2.0},
                                                  {0.001, 0.003, 2.0},
                                                  {0.001, 0.007, 2.0}})
    for (const bool turned : {false, true}) {
      const PressFigures f = press({.scene = "edge",
                                    .edge = edge,
                                    .depth_m = depth,
                                    .places = 60,
                                    .turned = turned,
                                    .seed = seed});
      std::printf("edge, e %g, %g m deep%s: %s\n", edge, depth, turned ? ", turned" : "",
                  reported(f).c_str());
      EXPECT_LT(f.direction_95, direction_95);
      EXPECT_GT(f.size_least, -0.02);
      EXPECT_LT(f.size_most, 0.005);
      EXPECT_LT(f.rest_worst, 1e-3);
    }
}

/// A moving object carries its edges: the force is the same, at the edge's place.
TEST(VirtualTool, FollowsTheEdgesOfAMovedObject) {
  const double e = 0.002, half = 0.03, depth = 0.005;
  const Vec3 slant = Vec3(1, 0, 1).normalized(), edge(half, 0.0007, 0.0);
  for (const Vec3& moved : {Vec3(0, 0, 0), Vec3(0.013, -0.004, 0.0071)}) {
    Rig rig(test::box_mesh(2 * half * Vec3::Ones(), {Vec3(0, 0, -half), Quat::Identity()}), e,
            ball_mesh());
    rig.displacement = moved;
    ASSERT_TRUE(rig.place({moved + edge + (kBall + 0.001) * slant, Quat::Identity()}));
    exact::VirtualToolFrame f;
    for (int n = 0; n <= 120; ++n)
      f = rig.frame(Vec3(moved + edge + (kBall + 0.001 - 5e-5 * n) * slant));
    EXPECT_NEAR(f.wrench(1.0).force.norm(), depth, 0.02 * depth);
    EXPECT_LT(degrees_between(f.wrench(1.0).force, slant), 4.0);
    EXPECT_NEAR((f.contact_point - moved - edge).head<1>().norm(), 0.0, 1e-9);
    EXPECT_NEAR(f.contact_point.z() - moved.z(), 0.0, 1e-9);
  }
}

/// Three walls that meet: the ball lies on all of them, or on two.
TEST(VirtualTool, GivesTheForceOfTheExactGodObjectInAConcaveCorner) {
  const std::uint64_t seed = testing::seed(7);
  SCOPED_TRACE(testing::seed_trace(seed));
  for (const double edge : {0.002, 0.001})
    for (const bool turned : {false, true}) {
      const PressFigures f =
          press({.scene = "corner", .edge = edge, .places = 40, .turned = turned, .seed = seed});
      std::printf("corner, e %g%s: %s\n", edge, turned ? ", turned" : "", reported(f).c_str());
      EXPECT_LT(f.direction_95, turned ? 1.0 : 0.1);
      EXPECT_LT(std::abs(f.size_median), 0.02);
      EXPECT_LT(f.rest_worst, 1e-3);
    }
}

TEST(VirtualTool, GivesTheSpringForceUpTo25Millimetres) {
  Rig rig(scene_mesh("plane"), 0.002, ball_mesh());
  const Vec3 free(0.0013, 0.0007, kBall + 0.002);
  ASSERT_TRUE(rig.place({free, Quat::Identity()}));
  double last = 0.0;
  for (int n = 0; n <= 540; ++n) {
    const double depth = -0.002 + n * 5e-5;
    const double force =
        rig.frame(Vec3(free.x(), free.y(), kBall - depth)).wrench(kStiffness).force.z();
    EXPECT_GE(force, last - 1e-3 * last) << depth;  // never falls while the hand moves deeper
    if (depth > 0.003) {
      EXPECT_NEAR(force / (kStiffness * depth), 1.0, 0.02) << depth;
    }
    last = force;
  }
}

TEST(VirtualTool, SlidesQuietlyOnPlanesAndCylinders) {
  for (const auto& [scene, noise, step] :
       {std::tuple{"plane", 1e-4, 1e-3}, {"tilted", 1e-4, 1e-3}, {"cylinder", 0.01, 0.1}})
    for (const double speed : {0.05, 0.5}) {
      const SlideFigures f = slide({.scene = scene, .speed = speed, .seed = 3});
      std::printf(
          "%s at %g m/s: noise %.5f, step over force %.5f, energy over way %.6f, queries %.2f\n",
          scene, speed, f.noise, f.step_over_force, f.energy_per_path, f.queries_mean);
      EXPECT_LT(f.noise, noise) << scene;
      EXPECT_LT(f.step_over_force, step) << scene;
      EXPECT_LE(f.energy_per_path, 1e-4) << scene;
      EXPECT_LE(f.queries_mean, speed < 0.1 ? 3.2 : 4.1) << scene;
      EXPECT_LE(f.queries_most, 7);
    }
}

TEST(VirtualTool, ReleasesOverAnEdgeAsARamp) {
  for (const double edge : {0.002, 0.001})
    for (const double depth : {0.003, 0.01}) {
      const EdgeFigures f = over_edge(edge, depth, 0.05, testing::seed(5), 6);
      std::printf("e %g, %g m deep: step %.3f N, %.3f of the force, energy %.4f J\n", edge, depth,
                  f.step_worst, f.step_over_force, f.energy);
      EXPECT_LT(f.step_over_force, 0.06);
      EXPECT_LT(f.energy, 0.0);
    }
}

/// Ball, hand on a path that never touches: bit-identically, up to four voxels a frame.
TEST(VirtualTool, EqualsTheHandInFreeSpace) {
  const std::uint64_t seed = testing::seed(7);
  SCOPED_TRACE(testing::seed_trace(seed));
  std::mt19937_64 random(seed);
  Rig rig(scene_mesh("plane"), 0.002, ball_mesh());
  Pose hand{Vec3(0, 0, 0.02), Quat::Identity()};
  Vec3 hand_step = Vec3::Zero();
  int queries = 0;
  for (int n = 0; n < 5000; ++n) {
    if (n % 10 == 0)
      hand_step = uniform(random, 0.0, 0.0075) * random_direction(random);
    hand.position += hand_step;
    for (int axis = 0; axis < 2; ++axis)
      hand.position[axis] = std::remainder(hand.position[axis], 0.08);
    hand.position.z() =
        kBall + 3e-4 + std::abs(std::remainder(hand.position.z() - kBall - 3e-4, 0.06));
    if (n % 100 == 0)
      rig.tool.reset();  // the jump at the borders is no motion
    hand.orientation =
        (Quat(Eigen::AngleAxisd(uniform(random, 0, 0.02), random_direction(random))) *
         hand.orientation)
            .normalized();
    if ((hand.position - rig.frame(hand).tool.position).norm() > 0.0) {
      // After a jump of the hand the tool follows at its own rate.
      for (int k = 0; k < 40; ++k)
        rig.frame(hand);
    }
    const exact::VirtualToolFrame f = rig.frame(hand);
    ASSERT_EQ(f.tool.position, hand.position) << n;
    ASSERT_EQ(f.tool.orientation.coeffs(), hand.orientation.coeffs()) << n;
    ASSERT_TRUE(f.wrench(kStiffness).zero());
    ASSERT_FALSE(f.constrained || f.not_converged || f.not_initialised);
    queries = std::max(queries, f.queries);
  }
  EXPECT_LE(queries, 1);
}

/// At 0.2 mm from a plane a tool of 10 mm is not followed any farther in a frame.
TEST(VirtualTool, EqualsTheHandUpToSevenMillimetresPerFrame) {
  Rig rig(scene_mesh("plane"), 0.002, ball_mesh());
  for (const double edges : {0.1, 1.0, 2.0, 3.45}) {
    ASSERT_TRUE(rig.place({Vec3(-0.04, 0, kBall + 2e-4), Quat::Identity()}));
    for (double x = -0.04; x < 0.04; x += edges * 0.002) {
      const Vec3 hand(x, 0.001, kBall + 2e-4);
      const exact::VirtualToolFrame f = rig.frame(hand);
      EXPECT_EQ(f.tool.position, hand) << edges << " e a frame";
      EXPECT_EQ(f.ratio, 1.0);
    }
  }
}

TEST(VirtualTool, ReportsNotConvergedForATooFastHand) {
  Rig rig(scene_mesh("plane"), 0.002, ball_mesh());
  ASSERT_TRUE(rig.place({Vec3(-0.04, 0, kBall + 2e-4), Quat::Identity()}));
  const Vec3 hand(0.02, 0, kBall + 2e-4);
  exact::VirtualToolFrame f = rig.frame(hand);
  EXPECT_TRUE(f.not_converged);
  EXPECT_TRUE(f.wrench(kStiffness).zero());
  EXPECT_LE(f.queries, 8);
  for (int n = 0; n < 10; ++n)
    f = rig.frame(hand);
  EXPECT_FALSE(f.not_converged);
  EXPECT_EQ(f.tool.position, hand);
}

TEST(VirtualTool, StiffnessNeverExceedsTheSpring) {
  Rig rig(scene_mesh("plane"), 0.002, ball_mesh());
  ASSERT_TRUE(rig.place({Vec3(0, 0, kBall + 0.001), Quat::Identity()}));
  exact::VirtualToolFrame f;
  for (int n = 0; n < 100; ++n)
    f = rig.frame(Vec3(1e-5 * n, 0, kBall + 0.001 - 5e-5 * n));
  const Mat6 k = f.stiffness(kStiffness);
  EXPECT_TRUE(k.isApprox(k.transpose(), 1e-9));
  const Vec6 eigen = Eigen::SelfAdjointEigenSolver<Mat6>(f.displayed).eigenvalues();
  EXPECT_GE(eigen.minCoeff(), -1e-12);
  EXPECT_LE(eigen.maxCoeff(), 1.0);
  EXPECT_NEAR(k(2, 2), kStiffness, 0.01 * kStiffness);
  EXPECT_NEAR(k(0, 0), 0.0, 0.01 * kStiffness);
  // It predicts the force.
  const double before = f.wrench(kStiffness).force.z();
  const double after =
      rig.frame(Vec3(1e-5 * 99, 0, kBall + 0.001 - 5e-5 * 99 - 1e-4)).wrench(kStiffness).force.z();
  EXPECT_NEAR((after - before) / 1e-4, k(2, 2), 0.02 * kStiffness);
}

TEST(VirtualTool, SumsItsPushesToTheSpring) {
  Rig rig(scene_mesh("cup"), 0.002, ball_mesh());
  ASSERT_TRUE(rig.place({Vec3(0, 0, 0.05), Quat::Identity()}));
  for (int n = 0; n < 400; ++n) {
    const exact::VirtualToolFrame f = rig.frame(Vec3(1e-4 * n, 2e-5 * n, 0.05 - 5e-5 * n));
    if (!f.constrained || f.residual_m > 1e-6)
      continue;
    const Wrench push = rig.tool.forces()[0], spring = f.wrench(1.0);
    EXPECT_LT((push.force - spring.force).norm(), 1e-5) << n;
    EXPECT_LT((push.torque - spring.torque).norm(), 1e-7) << n;
  }
}

TEST(VirtualToolFriction, IsCoulombsOnAPlane) {
  const SlideFigures f = slide({.scene = "plane", .friction = 0.4, .seed = 2});
  EXPECT_NEAR(f.direction_median, std::atan(0.4) * 180 / std::numbers::pi, 0.02);
  EXPECT_NEAR(f.direction_95, std::atan(0.4) * 180 / std::numbers::pi, 0.02);
  EXPECT_LT(f.noise, 1e-3);
  EXPECT_LT(f.energy_per_path, 0.0);
}

/// A hand that pulls along the plane with less than mu N: the tool stays in place, bit-identically,
/// for two seconds.
TEST(VirtualToolFriction, SticksWithinTheConeAndDoesNotCreep) {
  Rig rig(scene_mesh("tilted"), 0.002, ball_mesh());
  const Vec3 n = tilt() * Vec3::UnitZ(), t = tilt() * Vec3::UnitX();
  ASSERT_TRUE(rig.place({(kBall + 0.001) * n, Quat::Identity()}));
  for (int k = 0; k < 120; ++k)
    rig.frame((kBall + 0.001 - 5e-5 * k) * n, Quat::Identity(), 0.4);  // 5 mm deep
  for (int k = 0; k < 30; ++k)
    rig.frame((kBall - 0.005) * n + 5e-5 * k * t, Quat::Identity(),
              0.4);  // 1.5 mm along: 0.3 of it
  const Vec3 hand = (kBall - 0.005) * n + 1.5e-3 * t;
  rig.frame(hand, Quat::Identity(), 0.4);
  const Vec3 sticking = rig.frame(hand, Quat::Identity(), 0.4).tool.position;
  for (int k = 0; k < 2000; ++k)
    ASSERT_EQ(rig.frame(hand, Quat::Identity(), 0.4).tool.position, sticking) << k;
  EXPECT_LT(std::abs(sticking.dot(t)), 2e-4);  // it has rotated slightly about the sticking point
  for (int k = 0; k < 60; ++k)
    rig.frame(hand + 1e-4 * k * t, Quat::Identity(), 0.4);  // 7.5 mm along: it slides
  const exact::VirtualToolFrame f = rig.frame(hand + 6e-3 * t, Quat::Identity(), 0.4);
  EXPECT_GT(f.tool.position.dot(t), 4e-3);
  const Vec3 force = f.wrench(kStiffness).force;
  EXPECT_NEAR(-force.dot(t) / force.dot(n), 0.4, 1e-3);
}

TEST(VirtualToolFriction, OfZeroIsBitIdentical) {
  Rig with(scene_mesh("cup"), 0.002, ball_mesh()), without(scene_mesh("cup"), 0.002, ball_mesh());
  for (Rig* rig : {&with, &without})
    ASSERT_TRUE(rig->place({Vec3(0, 0, 0.05), Quat::Identity()}));
  for (int n = 0; n < 300; ++n) {
    const Vec3 hand(1e-4 * n, 2e-5 * n, 0.05);
    ASSERT_EQ(with.frame(hand, Quat::Identity(), 0.0).tool.position,
              without.frame(hand).tool.position);
  }
}

/// A square box of half width a on a plane: even pressure on its corners resists a rotation by mu N
/// r, r their distance from the centre.
TEST(VirtualToolFriction, HoldsARotationAboutTheNormal) {
  Rig rig(scene_mesh("plane"), 0.001, test::box_mesh(Vec3(0.012, 0.012, 0.008)));
  const double mu = 0.3, depth = 0.004;
  ASSERT_TRUE(rig.place({Vec3(3e-4, 2e-4, 0.005), Quat::Identity()}));
  exact::VirtualToolFrame f;
  for (int n = 0; n <= 100; ++n)
    f = rig.frame(Vec3(3e-4, 2e-4, 0.005 - n * (depth + 0.001) / 100), Quat::Identity(), mu);
  const Vec3 at(3e-4, 2e-4, 0.004 - depth);
  double most = 0.0;
  for (int n = 0; n <= 200; ++n) {
    f = rig.frame(at, Quat(Eigen::AngleAxisd(0.004 * n, Vec3::UnitZ())), mu);
    most = std::max(most, -f.wrench(kStiffness).torque.z());
  }
  const double push = f.wrench(kStiffness).force.z();
  EXPECT_NEAR(push, kStiffness * depth, 0.02 * kStiffness * depth);
  const double arm = most / (mu * push);  // mean distance of the contact forces from their centre
  std::printf("radius %.4f m\n", arm);
  EXPECT_GT(arm, 0.006 * 2.0 / 3.0);
  EXPECT_LT(arm, 0.006 * std::numbers::sqrt2 * 1.01);
  EXPECT_GT(f.rotation.z(), 0.05);  // the tool lags by what friction holds, and no more
  EXPECT_LT(f.rotation.z(), 0.7);
}

}  // namespace
}  // namespace voxtouch::virtual_tool
