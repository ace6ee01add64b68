// Hard cases of the virtual tool: irregular poses, levers and grids, balls, broken meshes, noise,
// and changes without effect.
#include <fenv.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/experiments/virtual_tool/open_meshes.hpp"
#include "tests/experiments/virtual_tool/runs.hpp"
#include "tests/hard/contact/virtual_tool_frames.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/contact/fixtures.hpp"

namespace voxtouch::virtual_tool {
namespace {

TEST(VirtualToolPoses, InvalidOnesLeaveTheToolInPlace) {
  Rig rig(scene_mesh("plane"), kEdge, ball_mesh());
  ASSERT_TRUE(rig.place({Vec3(0, 0, 0.0105), Quat::Identity()}));
  const Vec3 hand(0, 0, 0.004);
  exact::VirtualToolFrame good;
  for (int n = 0; n < 200; ++n)
    good = rig.frame(hand);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                   kInf = std::numeric_limits<double>::infinity();
  for (const Pose& bad :
       {Pose{Vec3(kNan, 0, 0), Quat::Identity()}, Pose{Vec3(0, kInf, 0), Quat::Identity()},
        Pose{Vec3(0, 0, 1e300), Quat::Identity()}, Pose{Vec3::Zero(), Quat(0, 0, 0, 0)},
        Pose{Vec3::Zero(), Quat(kNan, 0, 0, 0)}, Pose{Vec3::Zero(), Quat(1e9, 0, 0, 0)},
        Pose{Vec3(1e12, 0, 0), Quat::Identity()}}) {
    const exact::VirtualToolFrame f = rig.frame(bad);
    EXPECT_NE(f.pose_status, exact::PoseStatus::kUsable);
    EXPECT_TRUE(f.wrench(kStiffness).zero());
    EXPECT_EQ(f.tool.position, good.tool.position);
    const exact::VirtualToolFrame again = rig.frame(hand);
    EXPECT_EQ(again.tool.position, good.tool.position);
    EXPECT_EQ(again.wrench(kStiffness).force, good.wrench(kStiffness).force);
  }
}

TEST(VirtualToolPoses, AQuaternionAndItsNegativeAreOne) {
  const mesh::TriangleMesh box = test::box_mesh(Vec3(0.008, 0.012, 0.03));
  Rig plus(scene_mesh("cup"), kEdge, box), minus(scene_mesh("cup"), kEdge, box);
  for (Rig* rig : {&plus, &minus})
    ASSERT_TRUE(rig->place({Vec3(0, 0, 0.14), Quat::Identity()}));
  for (int n = 0; n < 800; ++n) {
    const Quat q(Eigen::AngleAxisd(0.005 * n, Vec3(1, 2, 3).normalized()));
    const Quat negative(-q.w(), -q.x(), -q.y(), -q.z());
    const Vec3 hand(1e-5 * n, 0, 0.14 - 2e-4 * n);
    const exact::VirtualToolFrame a = plus.frame(Pose{hand, q}),
                                  b = minus.frame(Pose{hand, n % 2 == 0 ? q : negative});
    ASSERT_EQ(a.tool.position, b.tool.position) << n;
    ASSERT_EQ(a.wrench(kStiffness).torque, b.wrench(kStiffness).torque) << n;
  }
}

/// A bar in a slot that cannot rotate, and a hand that keeps rotating: the torque keeps its axis
/// past 180 degrees by some degrees, then reverses.
TEST(VirtualToolPoses, HalfRotationOfTheHandGivesNoNoise) {
  const mesh::TriangleMesh bar = test::box_mesh(Vec3(0.03, 0.008, 0.008));
  Rig rig(slot_mesh(0.0095), 0.001, bar);
  const Quat along(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ()));
  ASSERT_TRUE(rig.place({Vec3(0, 0, -0.01), along}));
  std::mt19937_64 random(4);
  int turned_over = 0;
  Vec3 last = Vec3::Zero();
  for (int n = 0; n < 4000; ++n) {
    const double angle = std::min(0.001 * n, std::numbers::pi) +
                         1e-3 * uniform(random, -1, 1);  // then trembles about 180 degrees
    const exact::VirtualToolFrame f =
        rig.frame(Pose{Vec3(0, 0, -0.01), Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ())) * along});
    expect_sound(f);
    turned_over += n > 0 && f.rotation.dot(last) < 0.0;
    last = f.rotation;
  }
  EXPECT_LE(turned_over, 1);
  EXPECT_GT(last.norm(), 2.5);
}

TEST(VirtualToolPoses, AnyLeverNearTheReachIsSound) {
  const mesh::TriangleMesh box = test::box_mesh(Vec3(0.008, 0.012, 0.03));
  for (const double lever : {0.1, 1.0, 10.0}) {
    Rig rig(scene_mesh("cup"), kEdge, box, lever * 0.017);
    std::mt19937_64 random(testing::seed(9));
    Pose hand{Vec3(0, 0, 0.14), Quat::Identity()};
    ASSERT_TRUE(rig.place(hand));
    Vec3 target = Vec3::Zero();
    for (int n = 0; n < 1500; ++n) {
      if (n % 100 == 0)
        target = Vec3(uniform(random, -0.05, 0.05), uniform(random, -0.05, 0.05),
                      uniform(random, 0.0, 0.12));
      hand.position += 0.02 * (target - hand.position);
      hand.orientation =
          (Quat(Eigen::AngleAxisd(0.01, random_direction(random))) * hand.orientation).normalized();
      const exact::VirtualToolFrame f = rig.frame(hand);
      expect_sound(f);
      ASSERT_FALSE(inside(rig.mesh, f.tool.position)) << "lever " << lever << ", frame " << n;
    }
  }
}

/// Ball on ball: the top of a ball is not a minimum. Energy is only dissipated: the hand's work on
/// a closed loop is not negative.
TEST(VirtualToolBalls, OnABallSlideOffAndGiveNoEnergy) {
  Rig rig(test::sphere_mesh(0.02, 4), 0.001, ball_mesh());
  ASSERT_TRUE(rig.place({Vec3(1e-5, 0, 0.032), Quat::Identity()}));
  double work = 0.0;
  Vec3 last_force = Vec3::Zero(), last(1e-5, 0, 0.032);
  for (int n = 0; n <= 2400; ++n) {
    const double angle = 2 * std::numbers::pi * n / 2400;
    const Vec3 hand(0.004 * std::sin(2 * angle), 1e-5, 0.027 + 0.005 * std::cos(angle));
    const exact::VirtualToolFrame f = rig.frame(hand);
    expect_sound(f);
    const Vec3 force = f.wrench(kStiffness).force;
    work += 0.5 * (force + last_force).dot(hand - last);
    last_force = force, last = hand;
  }
  EXPECT_LE(work, 1e-6);
}

/// A box on its edge has no minimum either: it tips over or back. A hand that presses it on a
/// closed path gets no energy.
TEST(VirtualToolBoxes, OnTheirEdgeGiveNoEnergy) {
  for (const double edge : {0.002, 0.001}) {
    Rig rig(test::box_mesh(Vec3(0.06, 0.06, 0.04), {Vec3(0.3e-3, 0.1e-3, -0.02), Quat::Identity()}),
            edge, test::box_mesh(Vec3(0.02, 0.02, 0.02)));
    const Quat turn(Eigen::AngleAxisd(0.25 * std::numbers::pi, Vec3::UnitY()));
    ASSERT_TRUE(rig.place({Vec3(0.3e-3, 0, 0.016), turn}));
    double work = 0.0, most = 0.0;
    Vec3 last_force = Vec3::Zero(), last(0.3e-3, 0, 0.016);
    for (int n = 0; n <= 4000; ++n) {
      const double angle = 2 * std::numbers::pi * n / 4000;
      const Vec3 hand(0.3e-3 + 0.002 * std::sin(2 * angle), 0.0, 0.011 + 0.005 * std::cos(angle));
      const exact::VirtualToolFrame f = rig.frame(Pose{hand, turn});
      expect_sound(f);
      const Vec3 force = f.wrench(kStiffness).force;
      work += 0.5 * (force + last_force).dot(hand - last);
      most = std::max(most, force.norm());
      last_force = force, last = hand;
    }
    std::printf("e %g: %.3g J, %.2f N at most\n", edge, work, most);
    EXPECT_GT(most, 0.5);
    EXPECT_LE(work, 1e-6);
  }
}

/// Traps on for as long as it lives: the process ends at the first operation that is invalid,
/// divides by zero or overflows.
struct Traps {
  Traps() { feclearexcept(FE_ALL_EXCEPT), feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW); }
  ~Traps() { fedisableexcept(FE_ALL_EXCEPT); }
  Traps(const Traps&) = delete;
};

TEST(VirtualToolTraps, TumblingToolRaisesNoFloatingPointTrap) {
  const std::uint64_t seed = testing::seed(51);
  SCOPED_TRACE(testing::seed_trace(seed));
  for (const bool box : {false, true})
    for (const double friction : {0.0, 0.5}) {
      Rig rig(scene_mesh("cup"), kEdge,
              box ? test::box_mesh(Vec3(0.008, 0.012, 0.03)) : ball_mesh());
      std::mt19937_64 random(seed);
      Pose hand{Vec3(0, 0, 0.14), Quat::Identity()};
      Vec3 target = Vec3::Zero();
      const Traps traps;
      for (int n = 0; n < 4000; ++n) {
        if (n % 60 == 0)
          target = Vec3(uniform(random, -0.06, 0.06), uniform(random, -0.06, 0.06),
                        uniform(random, -0.02, 0.12));
        hand.position += 0.03 * (target - hand.position);
        hand.orientation =
            (Quat(Eigen::AngleAxisd(0.03, random_direction(random))) * hand.orientation)
                .normalized();
        if (n % 500 == 0)
          rig.tool.reset();
        expect_sound(rig.frame(hand, friction));
      }
    }
}

TEST(VirtualToolTumbling, CentreStaysOutsideAndFreePosesAreExact) {
  const std::uint64_t seed = testing::seed(52);
  SCOPED_TRACE(testing::seed_trace(seed));
  for (const bool box : {false, true})
    for (const double speed : {1.0, 3.0}) {
      const TumbleFigures f =
          tumble({.box = box, .speed = speed, .spin = 30 * speed, .frames = 2000, .seed = seed});
      std::printf("%s at %g m/s: contact %.2f, lag %.3f, queries %.1f\n", box ? "box" : "ball",
                  speed, f.contact_ratio, f.not_converged_ratio, f.queries_mean);
      EXPECT_EQ(f.inside, 0);
      EXPECT_EQ(f.not_exact, 0);
    }
}

class BrokenMesh : public ::testing::TestWithParam<int> {};
TEST_P(BrokenMesh, GivesSoundFrames) {
  mesh::TriangleMesh mesh = test::box_mesh(Vec3(0.04, 0.04, 0.02));
  if (GetParam() == 0)
    mesh.triangles.resize(9);  // open
  if (GetParam() == 1)
    mesh = test::inside_out(mesh);
  if (GetParam() == 2) {  // a Moebius strip
    mesh = {};
    for (std::uint32_t n = 0; n < 60; ++n) {
      const double angle = 2 * std::numbers::pi * n / 60;
      const Vec3 radial(std::cos(angle), std::sin(angle), 0);
      const Vec3 across = std::cos(angle / 2) * radial + std::sin(angle / 2) * Vec3::UnitZ();
      mesh.vertices.push_back(0.02 * radial + 0.006 * across);
      mesh.vertices.push_back(0.02 * radial - 0.006 * across);
      const std::uint32_t next = n == 59 ? 1 : 2 * n + 2, other = n == 59 ? 0 : 2 * n + 3;
      mesh.triangles.push_back({2 * n, 2 * n + 1, next});
      mesh.triangles.push_back({2 * n + 1, other, next});
    }
  }
  if (GetParam() == 3)
    mesh = test::joined(mesh, test::box_mesh(Vec3(0.02, 0.02, 0.04)));  // overlapping
  Rig rig(mesh, 0.001, ball_mesh());
  std::mt19937_64 random(testing::seed(31));
  Vec3 hand(0, 0, 0.06), target = Vec3::Zero();
  ASSERT_TRUE(rig.place({hand, Quat::Identity()}));
  for (int n = 0; n < 2000; ++n) {
    if (n % 100 == 0)
      target = 0.04 * random_direction(random);
    hand += 0.02 * (target - hand);
    const exact::VirtualToolFrame f = rig.frame(hand);
    expect_sound(f);
    if (GetParam() == 1 || GetParam() == 3) {
      ASSERT_FALSE(inside(rig.mesh, f.tool.position)) << n;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(OpenInvertedMoebiusOverlapping, BrokenMesh, ::testing::Range(0, 4));

/// Approached from either side, rubbed, released, at 0.1 to 4 e per frame: no open face enters a
/// ball, and at rest nothing changes. Rims may enter between a ball's points, in a few per cent of
/// runs: virtual_tool_runs open counts them.
TEST(VirtualToolOpenMeshes, HoldABallFromEitherSide) {
  int runs = 0, rims = 0;
  for (const char* const shape : open_shapes())
    for (const bool askew : {false, true}) {
      const DriveFigures f = drive({.shape = shape,
                                    .askew = askew,
                                    .tries = 2,
                                    .edges_per_frame = {0.1, 1.0, 4.0},
                                    .seed = testing::seed(5)});
      EXPECT_EQ(f.passed, 0) << shape << (askew ? " askew" : "");
      EXPECT_LT(f.rest_95, 0.03) << shape;
      EXPECT_EQ(f.runs, 6) << shape;
      EXPECT_GE(f.touched, 2) << shape;
      runs += f.runs, rims += f.rims;
    }
  std::printf("%d runs, %d rims in the ball\n", runs, rims);
  EXPECT_EQ(rims, 0);
}

/// The force begins at the sheet, on both of its sides.
TEST(VirtualToolOpenMeshes, PushFromEitherSideOn) {
  for (const double side : {-1.0, 1.0}) {
    Rig rig(scene_mesh("plate:0"), kEdge, ball_mesh());
    ASSERT_TRUE(rig.place({Vec3(1e-3, 2e-3, side * (kBall + 0.002)), Quat::Identity()}));
    exact::VirtualToolFrame f;
    for (int n = 1; n <= 240; ++n)
      f = rig.frame(Vec3(1e-3, 2e-3, side * (kBall + 0.002 - 5e-5 * n)));
    EXPECT_NEAR(f.wrench(kStiffness).force.z(), side * kStiffness * 0.01, 1e-2);
    EXPECT_NEAR(side * f.tool.position.z(), kBall, 4e-5);
  }
}

/// Encoder steps of 0.03 mm on a resting hand: force follows the steps and no more.
TEST(VirtualToolNoise, OfTheEncoderIsNotMadeLarger) {
  std::mt19937_64 random(testing::seed(41));
  for (const char* scene : {"plane", "tilted", "cylinder"}) {
    Rig rig(scene_mesh(scene), kEdge, ball_mesh());
    const Place place = random_place(scene, rig.mesh, random);
    ASSERT_TRUE(rig.place({place.point + (kBall + 0.001) * place.normal, Quat::Identity()}));
    Vec3 hand;
    for (int n = 0; n <= 120; ++n)
      rig.frame(hand = place.point + (kBall + 0.001 - 5e-5 * n) * place.normal);
    const double q = 3e-5;
    double most = 0.0;
    Vec3 last = rig.frame(hand).wrench(kStiffness).force;
    for (int n = 0; n < 2000; ++n) {
      const Vec3 shaken = hand + q * Vec3(std::round(uniform(random, -0.6, 0.6)),
                                          std::round(uniform(random, -0.6, 0.6)),
                                          std::round(uniform(random, -0.6, 0.6)));
      const Vec3 force = rig.frame(shaken).wrench(kStiffness).force;
      if (n > 100)
        most = std::max(most, (force - last).norm());
      last = force;
    }
    std::printf("%s: %.4f N, a step of the encoder is %.4f N\n", scene, most, kStiffness * q);
    EXPECT_LT(most, (std::string(scene) == "cylinder" ? 5.0 : 4.0) * kStiffness *
                        q);  // from corner to corner of a cube: sqrt(3) 2 q
  }
}

/// The scene moved by multiples of e, with numbers that a double holds exactly: bit-identical
/// results.
TEST(VirtualToolBits, AreEqualForASceneMovedByVoxels) {
  const double e = 0x1p-9;
  const Vec3 shift = e * Vec3(512, -1024, 256);
  const auto moved = [&](const Vec3& by) {
    mesh::TriangleMesh mesh =
        test::box_mesh(e * Vec3(32, 32, 16), {Vec3::Zero(), Quat::Identity()});
    for (Vec3& v : mesh.vertices)
      v += by;
    return mesh;
  };
  Rig here(moved(Vec3::Zero()), e, ball_mesh()), there(moved(shift), e, ball_mesh());
  const Vec3 start(0, 0, e * 16);
  ASSERT_TRUE(here.place({start, Quat::Identity()}));
  ASSERT_TRUE(there.place({start + shift, Quat::Identity()}));
  for (int n = 0; n < 1600; ++n) {  // over the edge
    const Vec3 hand = start + 0x1p-16 * Vec3(2 * n, n, -2 * n);
    const exact::VirtualToolFrame a = here.frame(hand), b = there.frame(Vec3(hand + shift));
    ASSERT_EQ(a.wrench(1.0).force, b.wrench(1.0).force) << n;
    ASSERT_EQ(a.tool.position + shift, b.tool.position) << n;
  }
}

TEST(VirtualToolBits, AreEqualForPowersOfTwoInScale) {
  const double e = 0x1p-9;
  const auto scaled = [&](double by) {
    mesh::TriangleMesh mesh =
        test::box_mesh(by * e * Vec3(32, 32, 16), {Vec3::Zero(), Quat::Identity()});
    return mesh;
  };
  for (const double by : {0.25, 8.0}) {
    Rig one(scaled(1.0), e, ball_mesh()), other(scaled(by), by * e, ball_mesh(by * kBall));
    const Vec3 start(0, 0, e * 16);
    ASSERT_TRUE(one.place({start, Quat::Identity()}));
    ASSERT_TRUE(other.place({by * start, Quat::Identity()}));
    for (int n = 0; n < 1600; ++n) {  // over the edge
      const Vec3 hand = start + 0x1p-16 * Vec3(2 * n, n, -2 * n);
      const Vec3 a = one.frame(hand).wrench(1.0).force,
                 b = other.frame(Vec3(by * hand)).wrench(1.0).force;
      ASSERT_EQ(Vec3(by * a), b) << "by " << by << ", frame " << n;
    }
  }
}

}  // namespace
}  // namespace voxtouch::virtual_tool
