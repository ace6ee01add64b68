// Hard cases of the virtual tool: thin walls, slots, pinching, moving objects, starts inside.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/experiments/virtual_tool/loops.hpp"
#include "tests/experiments/virtual_tool/runs.hpp"
#include "tests/hard/contact/virtual_tool_frames.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/contact/fixtures.hpp"

namespace voxtouch::virtual_tool {
namespace {

TEST(VirtualToolWalls, FromFoilsToFiveVoxelsHoldAndRest) {
  const std::uint64_t seed = testing::seed(21);
  SCOPED_TRACE(testing::seed_trace(seed));
  int runs = 0;
  for (const double thick : {0.01, 0.25, 0.5, 1.0, 2.0, 5.0})
    for (const bool askew : {false, true}) {
      const WallFigures f = walls({.thick_edges = thick, .askew = askew, .tries = 4, .seed = seed});
      EXPECT_EQ(f.passed, 0) << thick << " e" << (askew ? ", askew" : "");
      EXPECT_LT(f.depth_worst, 0.01) << thick;
      EXPECT_LT(f.rest_worst, 1e-3) << thick;
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
    Rig rig(test::box_mesh(Vec3(0.08, 0.08, 0.5 * kEdge), {Vec3(0.3e-3, 0.1e-3, 0), turn}), kEdge,
            ball_mesh());
    const Vec3 n = turn * Vec3::UnitZ();
    ASSERT_TRUE(rig.place({0.015 * n, Quat::Identity()}));
    for (int k = 0; k < 400; ++k)
      rig.frame((0.015 - 5e-4 * k) * n);
    for (int k = 0; k < 20000; ++k) {
      const exact::VirtualToolFrame f =
          rig.frame(-100 * kEdge * n + 1e-4 * random_direction(random));
      ASSERT_GT(n.dot(f.tool.position), 0.009) << k;
      ASSERT_TRUE(f.constrained);
    }
  }
}

/// Round the rim of a plate and back on the other side.
TEST(VirtualToolWalls, AllowAPathAroundARim) {
  Rig rig(test::box_mesh(Vec3(0.05, 0.05, 0.001), {Vec3(0.3e-3, 0.1e-3, 0.2e-3), tilt()}), kEdge,
          ball_mesh());
  ASSERT_TRUE(rig.place({tilt() * Vec3(0, 0, 0.03), Quat::Identity()}));
  for (int n = 0; n <= 2000; ++n) {
    const double angle = 2 * std::numbers::pi * n / 2000;
    const exact::VirtualToolFrame f =
        rig.frame(Vec3(tilt() * Vec3(0.05 * std::sin(angle), 0, 0.03 * std::cos(angle))));
    expect_sound(f);
  }
  const Vec3 home = tilt() * Vec3(0, 0, 0.03);
  for (int n = 0; n < 50; ++n)
    rig.frame(home);
  EXPECT_EQ(rig.frame(home).tool.position, home);
}

TEST(VirtualToolSlots, NarrowerThanTheToolKeepItOut) {
  Rig rig(slot_mesh(0.016), kEdge, ball_mesh());
  ASSERT_TRUE(rig.place({Vec3(0, 0, 0.02), Quat::Identity()}));
  exact::VirtualToolFrame f;
  for (int n = 0; n < 800; ++n) {
    f = rig.frame(Vec3(1e-3, 0, 0.02 - 5e-5 * n));
    expect_sound(f);
  }
  EXPECT_NEAR(f.tool.position.z(), std::sqrt(kBall * kBall - 0.008 * 0.008),
              1.5e-3);  // on the two edges
  EXPECT_NEAR(f.tool.position.x(), 0.0, 1.5e-3);
}

TEST(VirtualToolSlots, WiderThanTheToolExertNoForce) {
  Rig rig(slot_mesh(0.026), 0.001, ball_mesh());
  ASSERT_TRUE(rig.place({Vec3(0, 0, 0.02), Quat::Identity()}));
  for (int n = 0; n < 600; ++n) {
    const exact::VirtualToolFrame f = rig.frame(Vec3(0, 0, 0.02 - 5e-5 * n));
    ASSERT_FALSE(f.constrained) << n;
  }
}

/// Two slanted walls: the ball rests between them, at the height of both contacts.
TEST(VirtualToolSlots, InAWedgeTheToolRestsOnBothFaces) {
  const double half = std::numbers::pi / 6;  // 60 degrees between the walls
  const auto wall = [&](double side) {
    const Quat lean(Eigen::AngleAxisd(side * half, Vec3::UnitY()));
    return test::box_mesh(Vec3(0.02, 0.06, 0.1), {lean * Vec3(side * 0.01, 0, 0.03), lean});
  };
  Rig rig(test::joined(wall(1), wall(-1)), 0.001, ball_mesh());
  ASSERT_TRUE(rig.place({Vec3(0, 0, 0.05), Quat::Identity()}));
  exact::VirtualToolFrame f;
  for (int n = 0; n < 900; ++n) {
    f = rig.frame(Vec3(2e-4, 0, 0.05 - 5e-5 * n));
    expect_sound(f);
  }
  EXPECT_NEAR(f.tool.position.z(), kBall / std::sin(half), 1e-3);
  const Vec3 steady = f.wrench(kStiffness).force;
  for (int n = 0; n < 100; ++n)
    EXPECT_LT((rig.frame(Vec3(2e-4, 0, 0.005)).wrench(kStiffness).force - steady).norm(), 0.05);
}

/// A pin of 10 mm with a radial clearance of e/20 to e. Its bottom passes the mouth's edge within a
/// voxel: no row may treat the face around the mouth as one over the hole. At e = 2 mm the
/// interpolated distance is flat in the floor's corner for a voxel.
TEST(VirtualToolSlots, PinEntersItsHoleOnAFineGrid) {
  for (const auto& [edge, clearance, drag] : {std::tuple{0.0005, 2e-4, 0.2},
                                              {0.001, 2e-4, 0.2},
                                              {0.002, 2e-4, 0.2},
                                              {0.0005, 1e-4, 0.2},
                                              {0.001, 1e-4, 0.2},
                                              {0.002, 1e-4, 1.5},
                                              {0.001, 1e-3, 0.2}})
    for (const bool turned : {false, true}) {
      const PegFigures f = peg(edge, clearance, turned);
      std::printf("e %g, clearance %g: %.3f mm short, drag %.3f N\n", edge, clearance,
                  1e3 * f.short_m, f.drag_n);
      EXPECT_TRUE(f.entered);
      EXPECT_LT(f.short_m, edge > 0.001 ? 1.1 * edge : 0.5e-3);
      EXPECT_GT(f.short_m, -0.05e-3);
      EXPECT_LT(f.drag_n, drag);
    }
}

/// A bar against an edge 16 mm from the hand: the torque is that of the exact bar.
TEST(VirtualToolTorque, BarOverAnEdgeMatchesTheExactTorque) {
  const std::uint64_t seed = testing::seed(61);
  SCOPED_TRACE(testing::seed_trace(seed));
  for (const double edge : {0.002, 0.001})
    EXPECT_LT(lever(edge, seed).torque_error, 0.005);
}

/// A pin in its hole, 15 mm deep, the hand rotated slowly: the torque equals that of the exact pin,
/// with its play, at every angle. The mouth's edge has points at every height.
TEST(VirtualToolTorque, RotatedPinMatchesTheExactTorque) {
  const std::uint64_t seed = testing::seed(62);
  SCOPED_TRACE(testing::seed_trace(seed));
  for (const auto& [edge, clearance, degrees] : {std::tuple{0.001, 2e-4, 12.0},
                                                 {0.001, 1e-4, 12.0},
                                                 {0.0005, 1e-4, 12.0},
                                                 {0.001, 2e-4, 6.0},
                                                 {0.0005, 2e-4, 3.0},
                                                 {0.0005, 1e-4, 3.0}}) {
    const PinFigures f = pin(edge, clearance, degrees * std::numbers::pi / 180, seed);
    std::printf("e %g, clearance %g, %g degrees: %.4f N m, off by %.3f, step %.4f of it\n", edge,
                clearance, degrees, f.torque_nm, f.torque_error, f.step_over_torque);
    EXPECT_GT(f.torque_nm, 0.001);
    EXPECT_LT(f.torque_error, 0.05);
    EXPECT_LT(f.step_over_torque, 0.01);
  }
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

/// Objects of a scene, each with a displacement, and a ball.
struct Moving {
  rendering::ExactBodies bodies;
  rendering::ExactTool tool;
  std::vector<Vec3> displacements;
  explicit Moving(const std::vector<mesh::TriangleMesh>& meshes)
      : bodies(ball_mesh(), objects_of(meshes), kEdge),
        tool(bodies, meshes.size(), kBall),
        displacements(meshes.size(), Vec3::Zero()) {}
  exact::VirtualToolFrame frame(const Vec3& hand) {
    return tool.frame({{hand, Quat::Identity()}, kPeriod, 0.0}, displacements);
  }
  static std::vector<rendering::ExactBodies::Object> objects_of(
      const std::vector<mesh::TriangleMesh>& meshes) {
    std::vector<rendering::ExactBodies::Object> objects;
    for (std::size_t n = 0; n < meshes.size(); ++n)
      objects.push_back({.mesh = meshes[n], .objects = {n}, .owners = {}});
    return objects;
  }
};

/// Two blocks close on a ball until there is no space: it stays between them, and is free again
/// when they open.
TEST(VirtualToolSlots, PinchedBetweenTwoObjectsTheToolStaysBetween) {
  const mesh::TriangleMesh block = test::box_mesh(Vec3(0.04, 0.04, 0.02));
  Moving scene({block, block});
  scene.displacements = {Vec3(0, 0, -0.022), Vec3(0, 0, 0.022)};
  const Vec3 hand(0, 0, 1e-4);
  exact::VirtualToolFrame f;
  for (int n = 0; n < 50; ++n)
    f = scene.frame(Vec3::Zero());
  ASSERT_FALSE(f.not_initialised);
  for (int n = 0; n < 60; ++n) {  // closes to 18 mm for a ball of 20 mm
    scene.displacements[0].z() += 5e-5, scene.displacements[1].z() -= 5e-5;
    f = scene.frame(hand);
    expect_sound(f);
  }
  EXPECT_LT(std::abs(f.tool.position.z()), 1.1e-3);
  EXPECT_LT(f.wrench(kStiffness).force.norm(), kStiffness * 1.2e-3);
  EXPECT_TRUE(f.not_converged || f.object_delay_m > 0.0) << "the blocks are in the ball";
  for (int n = 0; n < 60; ++n) {
    scene.displacements[0].z() -= 5e-5, scene.displacements[1].z() += 5e-5;
    f = scene.frame(hand);
    expect_sound(f);
  }
  EXPECT_EQ(f.tool.position, hand);
}

TEST(VirtualToolObjects, ThatMoveCarryATool) {
  for (const double speed : {0.05, 0.5, 0.9}) {
    Moving scene({scene_mesh("plane")});
    const Vec3 hand(0, 0, kBall + 2e-4);
    for (int n = 0; n < 50; ++n)
      scene.frame(hand);
    ASSERT_TRUE(scene.tool.placed());
    for (int n = 0; n < 100; ++n) {
      scene.displacements[0] = Vec3(0, 0, speed * kPeriod * n);
      const exact::VirtualToolFrame f = scene.frame(hand);
      expect_sound(f);
      ASSERT_FALSE(f.passed_through);
      if (scene.displacements[0].z() > 1e-3) {
        ASSERT_NEAR(f.tool.position.z() - scene.displacements[0].z(), kBall, 2e-5)
            << speed << " m/s, frame " << n;
      }
    }
  }
}

/// A plate of 1 mm that moves 1.2 mm per frame carries the tool, or a flag reports that it passed.
TEST(VirtualToolObjects, AreNeverFastEnoughToPassUnreported) {
  Moving scene({test::box_mesh(Vec3(0.06, 0.06, 0.5 * kEdge))});
  scene.displacements[0] = Vec3(0, 0, -0.02);
  for (int n = 0; n < 50; ++n)
    scene.frame(Vec3::Zero());
  bool reported = false;
  exact::VirtualToolFrame f;
  for (int n = 0; n < 20; ++n) {
    scene.displacements[0].z() += 0.6 * kEdge;
    f = scene.frame(Vec3::Zero());
    expect_sound(f);
    reported = reported || f.passed_through;
    if (!reported) {
      ASSERT_GT(f.tool.position.z(), scene.displacements[0].z() + kBall - 5e-3) << n;
    }
  }
}

TEST(VirtualToolStart, InsideGivesNoForceUntilTheHandIsOut) {
  Rig rig(scene_mesh("plane"), kEdge, ball_mesh());
  bool placed = false;
  double first_force = 0.0;
  for (int n = 0; n < 600; ++n) {
    const double z = -0.02 + 1e-4 * n;  // from 30 mm deep to free
    const exact::VirtualToolFrame f = rig.frame(Vec3(0, 0, z));
    expect_sound(f);
    if (f.not_initialised) {
      ASSERT_TRUE(f.wrench(kStiffness).zero());
      ASSERT_LT(z, kBall + 5e-4);  // the check takes some frames
    } else if (!placed) {
      placed = true;
      EXPECT_GT(z, kBall - 5e-5);  // the facets of the ball
    }
    first_force = std::max(first_force, f.wrench(kStiffness).force.norm());
  }
  EXPECT_TRUE(placed);
  EXPECT_LT(first_force, 0.05);  // faded in
}

TEST(VirtualToolStart, InsideRejectsTheToolOfAnEarlierScene) {
  Rig rig(scene_mesh("plane"), kEdge, ball_mesh());
  EXPECT_FALSE(rig.place({Vec3(0, 0, -0.01), Quat::Identity()}));
  EXPECT_FALSE(rig.place({Vec3(0, 0, kBall - 0.05 * kEdge), Quat::Identity()}));
  EXPECT_TRUE(rig.place({Vec3(0, 0, kBall + 1e-5), Quat::Identity()}));
  EXPECT_EQ(rig.frame(Vec3(0, 0, kBall - 0.005)).ratio, 1.0);
}

TEST(VirtualToolStart, FadesInAfterAReset) {
  Rig rig(scene_mesh("plane"), kEdge, ball_mesh());
  rig.frame(Vec3(0, 0, 0.02));
  for (int n = 0; n < 120; ++n) {
    const exact::VirtualToolFrame f = rig.frame(Vec3(0, 0, 0.02 - 1e-4 * n));
    EXPECT_NEAR(f.ratio, (n + 1) * kPeriod / 0.2, 1e-9);
  }
  rig.tool.reset();
  EXPECT_TRUE(
      rig.frame(Vec3(0, 0, 0.005)).not_initialised);  // in contact: the hand must leave first
  EXPECT_FALSE(rig.frame(Vec3(0, 0, 0.02)).not_initialised);
}

}  // namespace
}  // namespace voxtouch::virtual_tool
