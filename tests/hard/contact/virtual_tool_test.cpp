// Hard cases of the virtual tool: thin walls, slots, pinching, starts inside, odd poses, broken meshes.
#include <fenv.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/contact/limits.hpp"
#include "tests/experiments/virtual_tool/loops.hpp"
#include "tests/experiments/virtual_tool/trials.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/contact/fixtures.hpp"

namespace voxtouch::virtual_tool {
namespace {

constexpr double kEdge = 0.002;

bool finite(const contact::VirtualToolFrame& f) {
  return f.tool.finite() && f.wrench(kStiffness).finite() && f.stiffness(kStiffness).allFinite() && f.contact_point.allFinite() &&
         std::isfinite(f.residual_m) && std::isfinite(f.worst_depth_m);
}

/// What holds in every frame, whatever the scene is.
void expect_sound(const contact::VirtualToolFrame& f) {
  ASSERT_TRUE(finite(f));
  ASSERT_LE(f.queries, 8 + 2);  // one more to start, or where an object has moved
  ASSERT_GE(f.share, 0.0);
  ASSERT_LE(f.share, 1.0);
}

TEST(VirtualToolWalls, FromAQuarterToFiveVoxelsAreNeverPassedAndLetTheToolRest) {
  const std::uint64_t seed = testing::seed(21);
  SCOPED_TRACE(testing::seed_trace(seed));
  int runs = 0;
  for (const double thick : {0.25, 0.5, 1.0, 2.0, 5.0})
    for (const bool askew : {false, true})
      for (const double phase : {0.0, 0.5}) {
        const WallFigures f = walls({.thick_edges = thick, .askew = askew, .phase_edges = phase, .tries = 2, .seed = seed});
        EXPECT_EQ(f.passed, 0) << thick << " e" << (askew ? ", askew" : "") << ", phase " << phase;
        EXPECT_LT(f.depth_worst, 0.3) << thick;
        EXPECT_LT(f.rest_worst, thick < 2.0 ? 0.03 : 1e-3) << thick;
        runs += f.runs;
      }
  std::printf("%d runs\n", runs);
  EXPECT_GT(runs, 200);
}

/// The hand a hundred voxels behind a wall of half a voxel, and trembling there.
TEST(VirtualToolWalls, HoldAgainstAHandFarBehind) {
  std::mt19937_64 random(testing::seed(22));
  for (const bool askew : {false, true}) {
    const Quat turn = askew ? tilt() : Quat::Identity();
    Rig rig(test::box_mesh(Vec3(0.08, 0.08, 0.5 * kEdge), {Vec3(0.3e-3, 0.1e-3, 0), turn}), kEdge, ball_shell(kEdge));
    const Vec3 n = turn * Vec3::UnitZ();
    ASSERT_TRUE(rig.place({0.015 * n, Quat::Identity()}));
    for (int k = 0; k < 400; ++k) rig.frame((0.015 - 5e-4 * k) * n);
    for (int k = 0; k < 20000; ++k) {
      const contact::VirtualToolFrame f = rig.frame(-100 * kEdge * n + 1e-4 * random_direction(random));
      ASSERT_GT(n.dot(f.tool.position), 0.009) << k;
      ASSERT_TRUE(f.saturated);
    }
  }
}

/// Round the rim of a plate and back on the other side.
TEST(VirtualToolWalls, LetTheHandGoRoundARim) {
  Rig rig(test::box_mesh(Vec3(0.05, 0.05, 0.001), {Vec3(0.3e-3, 0.1e-3, 0.2e-3), tilt()}), kEdge, ball_shell(kEdge));
  ASSERT_TRUE(rig.place({tilt() * Vec3(0, 0, 0.03), Quat::Identity()}));
  for (int n = 0; n <= 2000; ++n) {
    const double angle = 2 * std::numbers::pi * n / 2000;
    const contact::VirtualToolFrame f = rig.frame(Vec3(tilt() * Vec3(0.05 * std::sin(angle), 0, 0.03 * std::cos(angle))));
    expect_sound(f);
  }
  const Vec3 home = tilt() * Vec3(0, 0, 0.03);
  for (int n = 0; n < 50; ++n) rig.frame(home);
  EXPECT_EQ(rig.frame(home).tool.position, home);
}

mesh::TriangleMesh slot_mesh(double width) {
  return test::joined(test::box_mesh(Vec3(0.02, 0.06, 0.04), {Vec3(-0.5 * width - 0.01, 0, -0.02), Quat::Identity()}),
                      test::box_mesh(Vec3(0.02, 0.06, 0.04), {Vec3(0.5 * width + 0.01, 0, -0.02), Quat::Identity()}));
}

TEST(VirtualToolSlots, NarrowerThanTheToolKeepItOut) {
  Rig rig(slot_mesh(0.016), kEdge, ball_shell(kEdge));
  ASSERT_TRUE(rig.place({Vec3(0, 0, 0.02), Quat::Identity()}));
  contact::VirtualToolFrame f;
  for (int n = 0; n < 800; ++n) {
    f = rig.frame(Vec3(1e-3, 0, 0.02 - 5e-5 * n));
    expect_sound(f);
  }
  EXPECT_NEAR(f.tool.position.z(), std::sqrt(kBall * kBall - 0.008 * 0.008), 1.5e-3);  // on the two edges
  EXPECT_NEAR(f.tool.position.x(), 0.0, 1.5e-3);
}

TEST(VirtualToolSlots, WiderThanTheToolLetItInWithoutAForce) {
  Rig rig(slot_mesh(0.026), 0.001, ball_shell(0.001));
  ASSERT_TRUE(rig.place({Vec3(0, 0, 0.02), Quat::Identity()}));
  for (int n = 0; n < 600; ++n) {
    const contact::VirtualToolFrame f = rig.frame(Vec3(0, 0, 0.02 - 5e-5 * n));
    ASSERT_FALSE(f.constrained) << n;
  }
}

/// Two slanted walls: the ball comes to rest between them, at the height that both allow.
TEST(VirtualToolSlots, InAWedgeTheToolRestsOnBothFaces) {
  const double half = std::numbers::pi / 6;  // 60 degrees between the walls
  const auto wall = [&](double side) {
    const Quat lean(Eigen::AngleAxisd(side * half, Vec3::UnitY()));
    return test::box_mesh(Vec3(0.02, 0.06, 0.1), {lean * Vec3(side * 0.01, 0, 0.03), lean});
  };
  Rig rig(test::joined(wall(1), wall(-1)), 0.001, ball_shell(0.001));
  ASSERT_TRUE(rig.place({Vec3(0, 0, 0.05), Quat::Identity()}));
  contact::VirtualToolFrame f;
  for (int n = 0; n < 900; ++n) {
    f = rig.frame(Vec3(2e-4, 0, 0.05 - 5e-5 * n));
    expect_sound(f);
  }
  EXPECT_NEAR(f.tool.position.z(), kBall / std::sin(half), 1e-3);
  const Vec3 steady = f.wrench(kStiffness).force;
  for (int n = 0; n < 100; ++n) EXPECT_LT((rig.frame(Vec3(2e-4, 0, 0.005)).wrench(kStiffness).force - steady).norm(), 0.05);
}

/// A pin of 10 mm with a radial clearance of a tenth to two fifths of e; one of a twentieth stays out: the grid is too coarse.
TEST(VirtualToolSlots, APinGoesIntoItsHoleWhereTheGridIsFineEnough) {
  for (const auto& [edge, clearance, drag] : {std::tuple{0.0005, 2e-4, 0.2}, {0.001, 2e-4, 0.2}, {0.0005, 1e-4, 0.2}, {0.001, 1e-4, 0.6}})
    for (const bool turned : {false, true}) {
      const PegFigures f = peg(edge, clearance, turned);
      std::printf("e %g, clearance %g: %.3f mm short, drag %.3f N\n", edge, clearance, 1e3 * f.short_m, f.drag_n);
      EXPECT_TRUE(f.entered);
      EXPECT_LT(f.short_m, 0.5e-3);
      EXPECT_GT(f.short_m, -0.05e-3);
      EXPECT_LT(f.drag_n, drag);
    }
  EXPECT_FALSE(peg(0.002, 1e-4, false).entered);
}

/// A bar against an edge 16 mm from the hand: the torque is that of the exact bar.
TEST(VirtualToolTorque, OfABarOverAnEdgeIsTheExactOnes) {
  const std::uint64_t seed = testing::seed(61);
  SCOPED_TRACE(testing::seed_trace(seed));
  for (const double edge : {0.002, 0.001}) EXPECT_LT(lever(edge, seed).torque_error, 0.05);
}

TEST(VirtualToolLoop, IsStableUpToTheStiffnessOfALinearWall) {
  for (const double delay : {0.001, 0.002}) {
    const double linear = largest_stable_stiffness({.scene = "linear", .delay_s = delay});
    for (const char* scene : {"plane", "tilted"}) {
      const double k = largest_stable_stiffness({.scene = scene, .delay_s = delay});
      std::printf("%s, %g s late: %.0f N/m, linear wall %.0f N/m\n", scene, delay, k, linear);
      EXPECT_GE(k, 0.95 * linear);
    }
  }
}

/// Rows that oppose each other with no room between: halfway, finite, no way out.
TEST(VirtualToolSlots, PinchedBetweenTwoObjectsTheToolStaysHalfway) {
  const pointshell::Pointshell shell = ball_shell(0.001);
  const mesh::TriangleMesh block = test::box_mesh(Vec3(0.04, 0.04, 0.02));
  test::Ground ground(block, 0.001);
  contact::ContactQuery query(ground.voxmap, shell);
  contact::VirtualTool tool({.points = shell.size(), .objects = 2, .reach_m = query.reach_m(), .edge_m = 0.001});
  std::array<contact::ToolGround, 2> grounds{contact::ToolGround{&query, &ground.field, Vec3(0, 0, -0.022)},
                                             contact::ToolGround{&query, &ground.field, Vec3(0, 0, 0.022)}};
  ASSERT_TRUE(tool.place({Vec3::Zero(), Quat::Identity()}, grounds));
  contact::VirtualToolFrame f;
  for (int n = 0; n < 60; ++n) {  // closes to 18 mm for a ball of 20 mm
    grounds[0].displacement.z() += 5e-5, grounds[1].displacement.z() -= 5e-5;
    f = tool.frame({{Vec3(0, 0, 1e-4), Quat::Identity()}, kPeriod, 0.0}, grounds);
    expect_sound(f);
  }
  EXPECT_NEAR(f.tool.position.z(), 0.0, 2e-4);
  EXPECT_NEAR(f.worst_depth_m, 1e-3, 3e-4);
  EXPECT_GT(tool.pushes()[0].force.z(), 0.0);
  EXPECT_LT(tool.pushes()[1].force.z(), 0.0);
}

TEST(VirtualToolObjects, ThatMoveCarryATool) {
  const pointshell::Pointshell shell = ball_shell(kEdge);
  test::Ground ground(scene_mesh("plane"), kEdge);
  contact::ContactQuery query(ground.voxmap, shell);
  contact::VirtualTool tool({.points = shell.size(), .reach_m = query.reach_m(), .edge_m = kEdge});
  for (const double speed : {0.05, 0.5, 0.9}) {
    contact::ToolGround moving{&query, &ground.field, Vec3::Zero()};
    ASSERT_TRUE(tool.place({Vec3(0, 0, kBall + 2e-4), Quat::Identity()}, {&moving, 1}));
    for (int n = 0; n < 100; ++n) {
      moving.displacement = Vec3(0, 0, speed * kPeriod * n);
      const contact::VirtualToolFrame f = tool.frame({{Vec3(0, 0, kBall + 2e-4), Quat::Identity()}, kPeriod, 0.0}, {&moving, 1});
      expect_sound(f);
      ASSERT_FALSE(f.moved_too_far);
      if (moving.displacement.z() > 1e-3) {
        // The spring, up to 45 mm long, over rho.
        ASSERT_NEAR(f.tool.position.z() - moving.displacement.z(), kBall, 2e-4) << speed << " m/s, frame " << n;
        ASSERT_LE(f.queries, 8);
      }
    }
  }
}

TEST(VirtualToolObjects, FasterThanHalfAVoxelAFrameAreToldOf) {
  const pointshell::Pointshell shell = ball_shell(kEdge);
  test::Ground ground(test::box_mesh(Vec3(0.06, 0.06, 0.5 * kEdge)), kEdge);
  contact::ContactQuery query(ground.voxmap, shell);
  contact::VirtualTool tool({.points = shell.size(), .reach_m = query.reach_m(), .edge_m = kEdge});
  contact::ToolGround moving{&query, &ground.field, Vec3(0, 0, -0.02)};
  ASSERT_TRUE(tool.place({Vec3::Zero(), Quat::Identity()}, {&moving, 1}));
  bool told = false;
  for (int n = 0; n < 20; ++n) {
    moving.displacement.z() += 0.6 * kEdge;
    const contact::VirtualToolFrame f = tool.frame({{Vec3::Zero(), Quat::Identity()}, kPeriod, 0.0}, {&moving, 1});
    expect_sound(f);
    told = told || f.moved_too_far;
  }
  EXPECT_TRUE(told);
}

TEST(VirtualToolStart, InsideGivesNoForceUntilTheHandIsOut) {
  Rig rig(scene_mesh("plane"), kEdge, ball_shell(kEdge));
  bool placed = false;
  double first_force = 0.0;
  for (int n = 0; n < 600; ++n) {
    const double z = -0.02 + 1e-4 * n;  // from 30 mm deep to free
    const contact::VirtualToolFrame f = rig.frame(Vec3(0, 0, z));
    expect_sound(f);
    if (f.unplaced) {
      ASSERT_TRUE(f.wrench(kStiffness).zero());
      ASSERT_LT(z, kBall);
    } else if (!placed) {
      placed = true;
      EXPECT_GT(z, kBall - 1.1 * kEdge);  // no point deeper than half a voxel
    }
    first_force = std::max(first_force, f.wrench(kStiffness).force.norm());
  }
  EXPECT_TRUE(placed);
  EXPECT_LT(first_force, 0.05);  // faded in
}

TEST(VirtualToolStart, InsideIsNoPlaceForAToolOfASceneBefore) {
  Rig rig(scene_mesh("plane"), kEdge, ball_shell(kEdge));
  EXPECT_FALSE(rig.place({Vec3(0, 0, -0.01), Quat::Identity()}));
  EXPECT_FALSE(rig.place({Vec3(0, 0, kBall - kEdge), Quat::Identity()}));
  EXPECT_TRUE(rig.place({Vec3(0, 0, kBall - 0.1 * kEdge), Quat::Identity()}));
  EXPECT_EQ(rig.frame(Vec3(0, 0, kBall - 0.005)).share, 1.0);
}

TEST(VirtualToolStart, FadesInAfterAReset) {
  Rig rig(scene_mesh("plane"), kEdge, ball_shell(kEdge));
  rig.frame(Vec3(0, 0, 0.02));
  for (int n = 0; n < 120; ++n) {
    const contact::VirtualToolFrame f = rig.frame(Vec3(0, 0, 0.02 - 1e-4 * n));
    EXPECT_NEAR(f.share, (n + 1) * kPeriod / 0.2, 1e-9);
  }
  rig.tool.reset();
  EXPECT_TRUE(rig.frame(Vec3(0, 0, 0.005)).unplaced);  // in contact: the hand must come out first
  EXPECT_FALSE(rig.frame(Vec3(0, 0, 0.02)).unplaced);
}

TEST(VirtualToolPoses, ThatAreNoneLeaveTheToolWhereItIs) {
  Rig rig(scene_mesh("plane"), kEdge, ball_shell(kEdge));
  ASSERT_TRUE(rig.place({Vec3(0, 0, 0.0105), Quat::Identity()}));
  const Vec3 hand(0, 0, 0.004);
  contact::VirtualToolFrame good;
  for (int n = 0; n < 200; ++n) good = rig.frame(hand);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
  for (const Pose& bad : {Pose{Vec3(kNan, 0, 0), Quat::Identity()}, Pose{Vec3(0, kInf, 0), Quat::Identity()}, Pose{Vec3(0, 0, 1e300), Quat::Identity()},
                          Pose{Vec3::Zero(), Quat(0, 0, 0, 0)}, Pose{Vec3::Zero(), Quat(kNan, 0, 0, 0)}, Pose{Vec3::Zero(), Quat(1e9, 0, 0, 0)},
                          Pose{Vec3(1e12, 0, 0), Quat::Identity()}}) {
    const contact::VirtualToolFrame f = rig.frame(bad);
    EXPECT_NE(f.pose_status, contact::PoseStatus::kUsable);
    EXPECT_TRUE(f.wrench(kStiffness).zero());
    EXPECT_EQ(f.tool.position, good.tool.position);
    const contact::VirtualToolFrame again = rig.frame(hand);
    EXPECT_EQ(again.tool.position, good.tool.position);
    EXPECT_EQ(again.wrench(kStiffness).force, good.wrench(kStiffness).force);
  }
}

TEST(VirtualToolPoses, AQuaternionAndItsNegativeAreOne) {
  const pointshell::Pointshell box = shell_of(test::box_mesh(Vec3(0.008, 0.012, 0.03)), kEdge);
  Rig plus(scene_mesh("cup"), kEdge, box), minus(scene_mesh("cup"), kEdge, box);
  for (Rig* rig : {&plus, &minus}) ASSERT_TRUE(rig->place({Vec3(0, 0, 0.14), Quat::Identity()}));
  for (int n = 0; n < 800; ++n) {
    const Quat q(Eigen::AngleAxisd(0.005 * n, Vec3(1, 2, 3).normalized()));
    const Quat negative(-q.w(), -q.x(), -q.y(), -q.z());
    const Vec3 hand(1e-5 * n, 0, 0.14 - 2e-4 * n);
    const contact::VirtualToolFrame a = plus.frame(Pose{hand, q}), b = minus.frame(Pose{hand, n % 2 == 0 ? q : negative});
    ASSERT_EQ(a.tool.position, b.tool.position) << n;
    ASSERT_EQ(a.wrench(kStiffness).torque, b.wrench(kStiffness).torque) << n;
  }
}

/// A bar in a slot that cannot turn, a hand that turns on and on: the torque keeps its axis past half a turn by some degrees, then turns over.
TEST(VirtualToolPoses, AHandTurnedRoundByHalfATurnGivesNoNoise) {
  const pointshell::Pointshell bar = shell_of(test::box_mesh(Vec3(0.03, 0.008, 0.008)), 0.001);
  Rig rig(slot_mesh(0.0095), 0.001, bar);
  const Quat along(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ()));
  ASSERT_TRUE(rig.place({Vec3(0, 0, -0.01), along}));
  std::mt19937_64 random(4);
  int turned_over = 0;
  Vec3 last = Vec3::Zero();
  for (int n = 0; n < 4000; ++n) {
    const double angle = std::min(0.001 * n, std::numbers::pi) + 1e-3 * uniform(random, -1, 1);  // then trembles about half a turn
    const contact::VirtualToolFrame f = rig.frame(Pose{Vec3(0, 0, -0.01), Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ())) * along});
    expect_sound(f);
    turned_over += n > 0 && f.turn.dot(last) < 0.0;
    last = f.turn;
  }
  EXPECT_LE(turned_over, 1);
  EXPECT_GT(last.norm(), 2.5);
}

TEST(VirtualToolPoses, AnyLeverFromATenthToTenTimesTheReachIsSound) {
  const pointshell::Pointshell box = shell_of(test::box_mesh(Vec3(0.008, 0.012, 0.03)), kEdge);
  for (const double lever : {0.1, 1.0, 10.0}) {
    Rig rig(scene_mesh("cup"), kEdge, box, lever * 0.017);
    std::mt19937_64 random(testing::seed(9));
    Pose hand{Vec3(0, 0, 0.14), Quat::Identity()};
    ASSERT_TRUE(rig.place(hand));
    Vec3 target = Vec3::Zero();
    for (int n = 0; n < 1500; ++n) {
      if (n % 100 == 0) target = Vec3(uniform(random, -0.05, 0.05), uniform(random, -0.05, 0.05), uniform(random, 0.0, 0.12));
      hand.position += 0.02 * (target - hand.position);
      hand.orientation = (Quat(Eigen::AngleAxisd(0.01, random_direction(random))) * hand.orientation).normalized();
      const contact::VirtualToolFrame f = rig.frame(hand);
      expect_sound(f);
      ASSERT_LT(f.worst_depth_m, kEdge) << "lever " << lever << ", frame " << n;
    }
  }
}

/// 10^4 points flat on a plane: bounded rows, no turn, the same force for any order of the points.
TEST(VirtualToolMany, PointsFlatOnAPlaneAreAsGoodAsFew) {
  const pointshell::Pointshell shell = shell_of(test::box_mesh(Vec3(0.05, 0.05, 0.004)), 0.0005);
  ASSERT_GT(shell.size(), 20000U);
  std::vector<std::uint32_t> backwards(shell.size());
  for (std::uint32_t n = 0; n < backwards.size(); ++n) backwards[n] = static_cast<std::uint32_t>(shell.size()) - 1 - n;
  Rig a(scene_mesh("plane"), kEdge, shell), b(scene_mesh("plane"), kEdge, test::reordered(shell, backwards));
  contact::VirtualToolFrame fa, fb;
  for (Rig* rig : {&a, &b}) ASSERT_TRUE(rig->place({Vec3(0, 0, 0.003), Quat::Identity()}));
  for (int n = 0; n < 100; ++n) {
    const Vec3 hand(0, 0, 0.003 - 5e-5 * n);
    fa = a.frame(hand), fb = b.frame(hand);
    expect_sound(fa);
    ASSERT_LE(fa.rows, contact::limits::kMaxRows);
  }
  EXPECT_LT((fa.wrench(kStiffness).force - fb.wrench(kStiffness).force).norm(), 1e-4);
  EXPECT_LT(fa.turn.norm(), 1e-5);
  EXPECT_NEAR(fa.wrench(kStiffness).force.z(), kStiffness * (0.002 - (0.003 - 5e-5 * 99)), 1e-2);
}

/// Ball on ball: the top of a ball is no minimum. Energy is only lost: what the hand puts in on a closed loop is not less than nothing.
TEST(VirtualToolBalls, OnABallSlideOffAndGiveNoEnergy) {
  Rig rig(test::sphere_mesh(0.02, 4), 0.001, ball_shell(0.001));
  ASSERT_TRUE(rig.place({Vec3(1e-5, 0, 0.032), Quat::Identity()}));
  double work = 0.0;
  Vec3 last_force = Vec3::Zero(), last(1e-5, 0, 0.032);
  for (int n = 0; n <= 2400; ++n) {
    const double angle = 2 * std::numbers::pi * n / 2400;
    const Vec3 hand(0.004 * std::sin(2 * angle), 1e-5, 0.027 + 0.005 * std::cos(angle));
    const contact::VirtualToolFrame f = rig.frame(hand);
    expect_sound(f);
    const Vec3 force = f.wrench(kStiffness).force;
    work += 0.5 * (force + last_force).dot(hand - last);
    last_force = force, last = hand;
  }
  EXPECT_LE(work, 1e-6);
}

/// Traps on for as long as it lives: the process ends at the first operation that is invalid, divides by zero or overflows.
struct Traps {
  Traps() { feclearexcept(FE_ALL_EXCEPT), feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW); }
  ~Traps() { fedisableexcept(FE_ALL_EXCEPT); }
  Traps(const Traps&) = delete;
};

TEST(VirtualToolTraps, NoFrameOfATumblingToolIsInvalidOverflowsOrDividesByZero) {
  const std::uint64_t seed = testing::seed(51);
  SCOPED_TRACE(testing::seed_trace(seed));
  for (const bool box : {false, true})
    for (const double friction : {0.0, 0.5}) {
      const pointshell::Pointshell shell = box ? shell_of(test::box_mesh(Vec3(0.008, 0.012, 0.03)), kEdge) : ball_shell(kEdge);
      Rig rig(scene_mesh("cup"), kEdge, shell);
      std::mt19937_64 random(seed);
      Pose hand{Vec3(0, 0, 0.14), Quat::Identity()};
      Vec3 target = Vec3::Zero();
      const Traps traps;
      for (int n = 0; n < 4000; ++n) {
        if (n % 60 == 0) target = Vec3(uniform(random, -0.06, 0.06), uniform(random, -0.06, 0.06), uniform(random, -0.02, 0.12));
        hand.position += 0.03 * (target - hand.position);
        hand.orientation = (Quat(Eigen::AngleAxisd(0.03, random_direction(random))) * hand.orientation).normalized();
        if (n % 500 == 0) rig.tool.reset();
        expect_sound(rig.frame(hand, friction));
      }
    }
}

TEST(VirtualToolTumbling, NeverHasItsMiddleInsideAndIsFreeToTheBit) {
  const std::uint64_t seed = testing::seed(52);
  SCOPED_TRACE(testing::seed_trace(seed));
  for (const bool box : {false, true})
    for (const double speed : {1.0, 3.0}) {
      const TumbleFigures f = tumble({.box = box, .speed = speed, .spin = 30 * speed, .frames = 2000, .seed = seed});
      std::printf("%s at %g m/s: contact %.2f, lag %.3f, deepest row %.3f e, queries %.1f\n", box ? "box" : "ball", speed, f.contact_share,
                  f.lag_share, f.depth_worst, f.queries_mean);
      EXPECT_EQ(f.inside, 0);
      EXPECT_EQ(f.not_exact, 0);
      EXPECT_LT(f.depth_worst, 1.0);
    }
}

class BrokenMesh : public ::testing::TestWithParam<int> {};
TEST_P(BrokenMesh, GivesSoundFrames) {
  mesh::TriangleMesh mesh = test::box_mesh(Vec3(0.04, 0.04, 0.02));
  if (GetParam() == 0) mesh.triangles.resize(9);             // open
  if (GetParam() == 1) mesh = test::inside_out(mesh);
  if (GetParam() == 2) {                                     // a Moebius strip
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
  if (GetParam() == 3) mesh = test::joined(mesh, test::box_mesh(Vec3(0.02, 0.02, 0.04)));  // overlapping
  Rig rig(mesh, 0.001, ball_shell(0.001));
  std::mt19937_64 random(testing::seed(31));
  Vec3 hand(0, 0, 0.06), target = Vec3::Zero();
  ASSERT_TRUE(rig.place({hand, Quat::Identity()}));
  for (int n = 0; n < 2000; ++n) {
    if (n % 100 == 0) target = 0.04 * random_direction(random);
    hand += 0.02 * (target - hand);
    const contact::VirtualToolFrame f = rig.frame(hand);
    expect_sound(f);
    if (GetParam() == 1 || GetParam() == 3) {
      ASSERT_GE(rig.ground.field.at((f.tool.position - rig.ground.field.grid().origin) / 0.001).distance_m, 0.0) << n;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(OpenInvertedMoebiusOverlapping, BrokenMesh, ::testing::Range(0, 4));

/// Encoder steps of 0.03 mm on a resting hand: force follows the steps and no more.
TEST(VirtualToolNoise, OfTheEncoderIsNotMadeLarger) {
  std::mt19937_64 random(testing::seed(41));
  for (const char* scene : {"plane", "tilted", "cylinder"}) {
    Rig rig(scene_mesh(scene), kEdge, ball_shell(kEdge));
    const Place place = random_place(scene, rig.mesh, random);
    ASSERT_TRUE(rig.place({place.point + (kBall + 0.001) * place.normal, Quat::Identity()}));
    Vec3 hand;
    for (int n = 0; n <= 120; ++n) rig.frame(hand = place.point + (kBall + 0.001 - 5e-5 * n) * place.normal);
    const double q = 3e-5;
    double most = 0.0;
    Vec3 last = rig.frame(hand).wrench(kStiffness).force;
    for (int n = 0; n < 2000; ++n) {
      const Vec3 shaken = hand + q * Vec3(std::round(uniform(random, -0.6, 0.6)), std::round(uniform(random, -0.6, 0.6)), std::round(uniform(random, -0.6, 0.6)));
      const Vec3 force = rig.frame(shaken).wrench(kStiffness).force;
      if (n > 100) most = std::max(most, (force - last).norm());
      last = force;
    }
    std::printf("%s: %.4f N, a step of the encoder is %.4f N\n", scene, most, kStiffness * q);
    EXPECT_LT(most, (std::string(scene) == "cylinder" ? 5.0 : 4.0) * kStiffness * q);  // from corner to corner of a cube: sqrt(3) 2 q
  }
}

/// The scene moved by multiples of e, with numbers that a double holds exactly: the same bits.
TEST(VirtualToolBits, AreTheSameWhereTheSceneIsMovedByVoxels) {
  const double e = 0x1p-9;
  const Vec3 shift = e * Vec3(512, -1024, 256);
  const pointshell::Pointshell shell = ball_shell(e);
  const auto moved = [&](const Vec3& by) {
    mesh::TriangleMesh mesh = test::box_mesh(e * Vec3(32, 32, 16), {Vec3::Zero(), Quat::Identity()});
    for (Vec3& v : mesh.vertices) v += by;
    return mesh;
  };
  Rig here(moved(Vec3::Zero()), e, shell), there(moved(shift), e, shell);
  const Vec3 start(0, 0, e * 16);
  ASSERT_TRUE(here.place({start, Quat::Identity()}));
  ASSERT_TRUE(there.place({start + shift, Quat::Identity()}));
  for (int n = 0; n < 600; ++n) {
    const Vec3 hand = start + 0x1p-16 * Vec3(2 * n, n, -2 * n);
    const contact::VirtualToolFrame a = here.frame(hand), b = there.frame(Vec3(hand + shift));
    ASSERT_EQ(a.wrench(1.0).force, b.wrench(1.0).force) << n;
    ASSERT_EQ(a.tool.position + shift, b.tool.position) << n;
  }
}

TEST(VirtualToolBits, AreTheSameWhereAllIsScaledByAPowerOfTwo) {
  const double e = 0x1p-9;
  const auto scaled = [&](double by) {
    mesh::TriangleMesh mesh = test::box_mesh(by * e * Vec3(32, 32, 16), {Vec3::Zero(), Quat::Identity()});
    return mesh;
  };
  const auto shell = [&](double by) {
    pointshell::Pointshell points = ball_shell(e);
    for (auto* axis : {&points.x, &points.y, &points.z})
      for (double& x : *axis) x *= by;
    for (double& a : points.area_m2) a *= by * by;
    points.edge *= by;
    return points;
  };
  for (const double by : {0.25, 8.0}) {
    Rig one(scaled(1.0), e, shell(1.0)), other(scaled(by), by * e, shell(by));
    const Vec3 start(0, 0, e * 16);
    ASSERT_TRUE(one.place({start, Quat::Identity()}));
    ASSERT_TRUE(other.place({by * start, Quat::Identity()}));
    for (int n = 0; n < 600; ++n) {
      const Vec3 hand = start + 0x1p-16 * Vec3(2 * n, n, -2 * n);
      const Vec3 a = one.frame(hand).wrench(1.0).force, b = other.frame(Vec3(by * hand)).wrench(1.0).force;
      ASSERT_EQ(Vec3(by * a), b) << "by " << by << ", frame " << n;
    }
  }
}

}  // namespace
}  // namespace voxtouch::virtual_tool
