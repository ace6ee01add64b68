// A scene with a virtual tool: the force on the hand, and when there is none.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "core/rendering/live_scene.hpp"
#include "core/scene/scene_file.hpp"
#include "tests/support/heap_count/heap_count.hpp"

namespace voxtouch::rendering {
namespace {

constexpr double kSpring = 300.0, kDegree = std::numbers::pi / 180.0;

scene::Scene scene_of(const std::string& effects = "[]",
                      const std::string& statics = "[{mesh: plane.obj}]",
                      const std::string& more = "") {
  return scene::parse_scene("scene: tool\nvoxel_size: 0.002\nstatic: " + statics +
                                "\ndynamic: {mesh: sphere.obj, scale: 0.01}\ncontact: {rendering: "
                                "virtual_tool}\ncoupling: {design: auto}\neffects: " +
                                effects + "\n" + more,
                            std::string(VOXTOUCH_DEPLOY) + "/meshes/test.yaml");
}

/// The tool's origin is at z; the block's top is z = 0 and its bottom z = -0.02, the ball's radius
/// 10 mm.
ToolState at(double z, double x = 0.003) {
  ToolState tool;
  tool.pose.position = Vec3(x, 0.002, z);
  return tool;
}

/// A scene that renders a frame a millisecond.
struct Rig {
  explicit Rig(const scene::Scene& scene) : built(build_scene(scene, serial_for())), live(*built) {
    live.set_spring_target(kSpring);
  }
  SceneFrame operator()(const ToolState& tool) { return live.render(tool, 1e-3 * n++); }
  SceneFrame hold(const ToolState& tool, int frames) {
    SceneFrame frame;
    for (int i = 0; i < frames; ++i)
      frame = (*this)(tool);
    return frame;
  }
  /// From above down to z, 50 mm/s, after the fade.
  SceneFrame press(double z) {
    SceneFrame frame = hold(at(0.012), 250);
    for (double now = 0.012; now > z; now -= 5e-5)
      frame = (*this)(at(now));
    return hold(at(z), 20);
  }
  std::unique_ptr<BuiltScene> built;
  LiveScene live;
  int n = 0;
};

TEST(VirtualToolScene, EqualsTheHandInFreeSpace) {
  Rig rig(scene_of());
  for (int i = 0; i < 300; ++i) {
    const ToolState hand = at(0.03 + 0.01 * std::sin(0.01 * i), 0.01 * std::cos(0.017 * i));
    const SceneFrame frame = rig(hand);
    ASSERT_EQ(frame.object.position, hand.pose.position);
    ASSERT_TRUE(frame.wrench.zero());
    ASSERT_FALSE(frame.tool.constrained || frame.tool.not_initialised || frame.tool.not_converged);
    ASSERT_EQ(frame.stiffness_bound_n_per_m, 0.0);
  }
}

TEST(VirtualToolScene, GivesSpringTimesDisplacementAtEveryDepth) {
  Rig rig(scene_of());
  rig.press(0.0095);
  double last = 0.0;
  for (double depth = 0.001; depth <= 0.04; depth += 0.001) {
    for (int i = 1; i <= 20; ++i)
      rig(at(0.01 - depth + 1e-3 - 5e-5 * i));
    const SceneFrame frame = rig.hold(at(0.01 - depth), 20);
    const double force = frame.wrench.force.z();
    ASSERT_TRUE(frame.tool.constrained);
    EXPECT_NEAR(force, kSpring * depth, 0.07)
        << depth << ": what the shell's points lack of a ball";
    EXPECT_GT(force, last);
    EXPECT_LT(frame.wrench.force.head<2>().norm(), 1e-3 * force);
    EXPECT_NEAR(frame.object.position.z(), 0.01, 3e-4) << "outside";
    EXPECT_EQ(frame.stiffness_bound_n_per_m, kSpring);
    const double most =
        Eigen::SelfAdjointEigenSolver<Mat3>(frame.stiffness.topLeftCorner<3, 3>()).eigenvalues()[2];
    EXPECT_LE(most, kSpring);
    EXPECT_GE(most, 0.99 * kSpring);
    last = force;
  }
}

/// While the coupling is being designed: a flag reports it, so that zero force of a deep hand is
/// not counted as an error.
TEST(VirtualToolScene, ReportsNoForceUntilItsSpringIsKnown) {
  Rig rig(scene_of());
  rig.live.set_spring_target(0.0);
  rig(at(0.012));
  SceneFrame frame = rig.press(0.008);
  EXPECT_TRUE(frame.tool.constrained && frame.tool.not_initialised);
  EXPECT_TRUE(frame.wrench.zero());
  rig.live.set_spring_target(kSpring);
  const double at_once = rig(at(0.008)).wrench.force.norm();
  EXPECT_LT(at_once, 0.01);
  frame = rig.hold(at(0.008), 500);
  EXPECT_FALSE(frame.tool.not_initialised);
  EXPECT_NEAR(frame.wrench.force.z(), kSpring * 0.002, 0.07);
}

TEST(VirtualToolScene, FadesInOnlyAfterAFreeStart) {
  Rig rig(scene_of());
  const SceneFrame inside = rig.hold(at(-0.01), 50);
  EXPECT_TRUE(inside.tool.not_initialised);
  EXPECT_TRUE(inside.wrench.zero());
  EXPECT_EQ(inside.stiffness_bound_n_per_m, 0.0);
  double largest_step = 0.0, last = 0.0;
  for (double z = -0.01; z < 0.013; z += 1e-4) {
    const double force = rig(at(z)).wrench.force.norm();
    largest_step = std::max(largest_step, std::abs(force - last)), last = force;
  }
  EXPECT_EQ(last, 0.0);
  EXPECT_LT(largest_step, 0.05);
  EXPECT_GT(rig.press(0.005).wrench.force.z(), 1.3);
}

TEST(VirtualToolScene, StaysThroughAClutchALossAndAJumpIntoAWall) {
  Rig clutch(scene_of()), loss(scene_of()), jump(scene_of());
  for (Rig* rig : {&clutch, &loss, &jump})
    ASSERT_GT(rig->press(0.0).wrench.force.z(), 2.8);
  ToolState clutched = at(0.0);
  clutched.clutched = true;
  EXPECT_GT(clutch.hold(clutched, 300).object.position.z(), 0.0095);
  EXPECT_GT(clutch(at(0.0)).wrench.force.z(), 2.8);
  loss.live.reset_virtual_tool();
  EXPECT_LT(loss(at(0.0)).wrench.force.z(), 0.05) << "it fades in";
  const SceneFrame after = loss.hold(at(0.0), 250);
  EXPECT_FALSE(after.tool.not_initialised);
  EXPECT_GT(after.wrench.force.z(), 2.8);
  EXPECT_LT(jump(at(-0.005, 0.05)).wrench.force.norm(), 0.1) << "50 m/s";
  EXPECT_GT(jump.hold(at(-0.005, 0.05), 250).object.position.z(), 0.0095);
}

TEST(VirtualToolScene, RestartsInFreeSpaceAfterLossOrSession) {
  Rig loss(scene_of()), session(scene_of());
  for (Rig* rig : {&loss, &session})
    ASSERT_GT(rig->press(0.0).wrench.force.z(), 2.8);
  loss.live.reset_virtual_tool();
  EXPECT_EQ(loss(at(-0.05)).object.position, at(-0.05).pose.position) << "below the block";
  session.live.reset();
  EXPECT_TRUE(session(at(0.0)).tool.not_initialised);
}

TEST(VirtualToolScene, KeepsTheToolForAnInvalidPose) {
  Rig rig(scene_of());
  const double before = rig.press(0.0).wrench.force.z();
  ToolState none = at(0.0);
  none.pose.position.x() = std::nan("");
  const SceneFrame frame = rig(none);
  EXPECT_TRUE(frame.wrench.zero());
  EXPECT_TRUE(frame.wrench.finite() && frame.stiffness.allFinite());
  EXPECT_TRUE(frame.tool.not_initialised);
  EXPECT_NEAR(rig(at(0.0)).wrench.force.z(), before, 1e-6);
}

TEST(VirtualToolScene, RampsItsSpringAndReportsTheEnergy) {
  Rig rig(scene_of());
  SceneFrame frame = rig.press(0.0);
  const double supplied = frame.supplied_energy_j;
  rig.live.set_spring_target(2.0 * kSpring);
  double last = frame.wrench.force.z(), largest_step = 0.0;
  for (int i = 0; i < 250; ++i) {
    frame = rig(at(0.0));
    largest_step = std::max(largest_step, std::abs(frame.wrench.force.z() - last)),
    last = frame.wrench.force.z();
  }
  EXPECT_NEAR(last, 2.0 * kSpring * 0.01, 0.1);
  EXPECT_LT(largest_step, 0.02);
  EXPECT_NEAR(frame.supplied_energy_j - supplied, 0.5 * kSpring * 1e-4, 1e-3);
  rig.live.set_spring_target(std::nan(""));
  EXPECT_LT(rig.hold(at(0.0), 250).wrench.force.z(), 1e-9) << "no number is no spring";
  rig.live.set_spring_target(kSpring);
  EXPECT_GT(rig.hold(at(0.0), 250).wrench.force.z(), 2.9) << "and not for ever";
}

TEST(VirtualToolScene, KeepsTheToolWhenTheSceneIsRebuilt) {
  Rig rig(scene_of());
  const double before = rig.press(0.0).wrench.force.z();
  scene::Scene finer = scene_of();
  finer.voxel_size_m = 0.001;
  const auto next = build_scene(finer, serial_for());
  rig.live.swap_to(*next);
  for (int i = 0; i < 300; ++i)
    EXPECT_NEAR(rig(at(0.0)).wrench.force.z(), before, 0.1) << i;
  EXPECT_EQ(rig.live.retired(), rig.built.get());
}

TEST(VirtualToolScene, DropsTheToolInsideANewWall) {
  Rig rig(scene_of());
  rig.press(0.0);
  const auto next =
      build_scene(scene_of("[]", "[{mesh: plane.obj, position: [0, 0, 0.012]}]"), serial_for());
  rig.live.swap_to(*next);
  const SceneFrame frame = rig.hold(at(0.0), 300);
  EXPECT_TRUE(frame.wrench.zero());
  EXPECT_TRUE(frame.tool.not_initialised);
}

TEST(VirtualToolScene, MovingObjectsPushItAndReportTheirWork) {
  Rig rig(scene_of("[]",
                   "[{mesh: plane.obj, object: {name: lift, moves: {path: [[0, 0, -0.02], [0, 0, "
                   "0.02]], speed_m_per_s: 0.02}}}]"));
  SceneFrame frame;
  double work = 0.0, last_z = 0.0;
  for (int i = 0; i < 5000; ++i) {
    frame = rig(at(0.01));
    work += frame.wrench.force.z() * (i == 0 ? 0.0 : frame.object.position.z() - last_z);
    last_z = frame.object.position.z();
  }
  EXPECT_NEAR(frame.wrench.force.z(), kSpring * 0.02, 0.1);
  EXPECT_GT(work, 0.04);
  EXPECT_NEAR(frame.supplied_energy_j, work, 0.05 * work);
  EXPECT_LT(frame.tool.queries, 9u);
}

TEST(VirtualToolScene, SpaceEffectsActAtTheHandOthersAtTheTool) {
  Rig magnet(
      scene_of("[{guide_plane: {point: [0, 0, 0], normal: [0, 0, 1], stiffness_n_per_m: 100, "
               "limit_n: 5}}]"));
  const SceneFrame drawn = magnet.press(0.0);
  Rig none(scene_of());
  const SceneFrame bare = none.press(0.0);
  EXPECT_NEAR(drawn.effects.wrench.force.norm(), 0.0, 1e-6)
      << "the hand is in the plane; the tool is 10 mm above it";
  EXPECT_NEAR((drawn.touch.contact.wrench.force - bare.touch.contact.wrench.force).norm(), 0.0,
              1e-9);

  Rig oil(scene_of("[{surface_damping: {damping_ns_per_m: 2}}]"));
  oil.press(0.0);
  SceneFrame frame;
  for (int i = 0; i < 200; ++i)
    frame = oil(at(0.0, 0.003 + 5e-5 * i));
  EXPECT_NEAR(frame.effects.wrench.force.x(), -2.0 * 0.05, 0.02) << "50 mm/s of the tool";
}

TEST(VirtualToolScene, RubsByTheEffectOfThatName) {
  Rig rig(scene_of("[{friction: {coulomb: 0.4}}]"));
  rig.press(0.0);
  SceneFrame frame;
  for (int i = 0; i < 600; ++i)
    frame = rig(at(0.0, 0.003 + 5e-5 * i));
  EXPECT_NEAR(-frame.wrench.force.x() / frame.wrench.force.z(), 0.4, 0.01);
  EXPECT_TRUE(frame.effects.wrench.zero()) << "not twice";
}

TEST(VirtualToolScene, FramesUseNoHeap) {
  if (!test::heap_is_counted())
    GTEST_SKIP() << "the sanitizer owns malloc";
  Rig rig(
      scene_of("[{friction: {coulomb: 0.4}}, {texture: {pattern: noise, wavelength_m: 0.006, "
               "force_n: 0.1, full_force_n: 0.3, reach_m: 0.02}}]"));
  rig.press(0.0);
  EXPECT_EQ(test::heap_count_of([&] {
              for (int i = 0; i < 200; ++i)
                rig(at(0.0, 0.003 + 5e-5 * i));
              rig.live.reset_virtual_tool();
              rig.live.set_spring_target(100.0);
              rig(at(0.0));
              rig(at(0.03));
            }),
            0);
}

/// A plate of 60 mm with its top at z = 0, as a file.
std::string plate(double thick) {
  const std::string file =
      std::filesystem::temp_directory_path() / ("voxtouch_plate_" + std::to_string(thick) + ".obj");
  std::ofstream out(file);
  for (int k = 0; k < 8; ++k)
    out << "v " << (k & 1 ? 0.03 : -0.03) << " " << (k & 2 ? 0.03 : -0.03) << " "
        << (k & 4 ? 0.0 : -thick) << "\n";
  out << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  return file;
}

void holds_plate(double thick) {
  SCOPED_TRACE(thick);
  Rig rig(scene_of("[]", "[{mesh: " + plate(thick) + "}]"));
  ToolState hand = at(0.012, 0.0);
  hand.pose.position.y() = 0.0;
  rig.hold(hand, 250);
  SceneFrame frame;
  for (double z = 0.012; z > -0.02; z -= 1e-4)
    hand.pose.position.z() = z, frame = rig(hand);
  EXPECT_GT(frame.wrench.force.z(), 0.95 * kSpring * 0.03)
      << "the hand is through; the tool at " << frame.object.position.transpose();
}

TEST(VirtualToolScene, HoldsPlatesOfAVoxelAndLess) {
  for (const double thick : {0.0005, 0.002, 0.003})
    holds_plate(thick);
}

/// Straight onto the rim of a thick plate, at rest and carried by an object: the spring's force for
/// the exact ball's displacement.
TEST(VirtualToolScene, GivesTheExactBallsForceAtAConvexEdge) {
  const double depth = 0.005;
  for (const bool moves : {false, true}) {
    const std::string lift =
        ", object: {name: lift, moves: {path: [[0, 0, 0.004], [0, 0, 0.0041]], speed_m_per_s: "
        "0.0001}}";
    Rig rig(scene_of("[]", "[{mesh: " + plate(0.02) + (moves ? lift : "") + "}]"));
    ToolState hand;
    const Vec3 slant = Vec3(1, 0, 1).normalized();
    SceneFrame frame;
    const auto hand_at = [&](double displacement) {
      hand.pose.position =
          Vec3(0.03, 0.0007, moves ? 0.004 + 1e-7 * rig.n : 0.0) + (0.01 + displacement) * slant;
    };
    for (int n = 0; n < 250; ++n)
      hand_at(0.002), frame = rig(hand);
    for (int n = 0; n <= 140; ++n)
      hand_at(0.002 - n * (0.002 + depth) / 140), frame = rig(hand);
    for (int n = 0; n < 50; ++n)
      hand_at(-depth), frame = rig(hand);
    EXPECT_NEAR(frame.wrench.force.norm(), kSpring * depth, 0.02 * kSpring * depth) << moves;
    // An edge of the mesh meets a facet, with a normal up to 4 degrees off the ball's.
    const double facets = std::cos(4.0 * kDegree);
    EXPECT_GT(frame.wrench.force.normalized().dot(slant), facets);
  }
}

/// Into the cup from above, over its rim and out again: never through a wall, and at the hand's
/// pose without contact.
TEST(VirtualToolScene, GoesIntoACupAndOutOfIt) {
  Rig rig(scene_of("[]", "[{mesh: cup.obj}]"));
  ToolState hand;
  hand.pose.position = Vec3(0, 0, 0.13);
  rig.hold(hand, 250);
  SceneFrame frame;
  for (int n = 0; n <= 3000; ++n) {
    const double turn = 2.0 * std::numbers::pi * n / 1500.0, deep = std::min(n, 3000 - n) / 1500.0;
    hand.pose.position =
        Vec3(0.06 * deep * std::cos(turn), 0.06 * deep * std::sin(turn), 0.13 - 0.12 * deep);
    frame = rig(hand);
    ASSERT_TRUE(frame.wrench.finite());
    ASSERT_FALSE(frame.tool.not_initialised);
    ASSERT_LT(frame.object.position.head<2>().norm(), 0.045) << n << ": through the wall";
  }
  EXPECT_EQ(rig(hand).object.position, hand.pose.position);
}

/// A ball laid on a plane so lightly that the spring is shorter than a tenth of a millimetre: the
/// force is the spring's, and rests.
TEST(VirtualToolScene, RestsInAGentleTouch) {
  Rig rig(scene_of());
  SceneFrame frame = rig.press(0.0099);
  const Vec3 force = frame.wrench.force;
  EXPECT_NEAR(force.z(), kSpring * 1e-4, 0.02);
  for (int n = 0; n < 200; ++n)
    ASSERT_LT((rig(at(0.0099)).wrench.force - force).norm(), 1e-9);
}

/// Two separate blocks, each an object: the force is the sum of both.
TEST(VirtualToolScene, RestsInTheCornerOfTwoObjects) {
  Rig rig(scene_of("[{friction: {coulomb: 0.0}}]",
                   "[{mesh: " + plate(0.02) + ", object: {name: floor}}, {mesh: " + plate(0.02) +
                       ", position: [0.0305, 0, 0.031], orientation: [0.70710678118654752, 0, "
                       "-0.70710678118654752, 0], object: "
                       "{name: wall}}]"));
  ToolState hand;
  hand.pose.position = Vec3(0.0, 0.0, 0.02);
  rig.hold(hand, 250);
  SceneFrame frame;
  for (int n = 0; n < 400; ++n) {
    hand.pose.position += Vec3(6e-5, 0, -5e-5);
    frame = rig(hand);
  }
  frame = rig.hold(hand, 50);
  EXPECT_NEAR(frame.wrench.force.z(), kSpring * 0.01, 0.1);
  EXPECT_NEAR(frame.wrench.force.x(), -kSpring * (0.024 - 0.0205), 0.1);
}

/// Equal frames give bit-identical results, in another scene.
TEST(VirtualToolScene, SameFramesAreBitIdentical) {
  const scene::Scene scene = scene_of("[{friction: {coulomb: 0.3}}]", "[{mesh: cup.obj}]");
  Rig one(scene), other(scene);
  for (int n = 0; n < 1500; ++n) {
    ToolState hand;
    hand.pose.position = Vec3(0.05 * std::sin(0.006 * n), 0.05 * std::sin(0.0041 * n),
                              0.06 + 0.07 * std::cos(0.0047 * n));
    hand.pose.orientation = Eigen::AngleAxisd(0.003 * n, Vec3(1, 2, 3).normalized());
    const SceneFrame a = one(hand), b = other(hand);
    ASSERT_EQ(a.wrench.force, b.wrench.force) << n;
    ASSERT_EQ(a.wrench.torque, b.wrench.torque) << n;
    ASSERT_EQ(a.stiffness, b.stiffness) << n;
    ASSERT_EQ(a.object.position, b.object.position) << n;
    ASSERT_EQ(a.tool.queries, b.tool.queries) << n;
  }
}

/// At voxels of 2 mm, 1 m/s: a foil of a hundredth of a voxel.
TEST(VirtualToolScene, HoldsAFoilOfAHundredthOfAVoxel) { holds_plate(2e-5); }

/// Inverted triangles enclose the same block.
TEST(VirtualToolScene, PushesOutOfAnInvertedBlock) {
  const std::string file = std::filesystem::temp_directory_path() / "voxtouch_inside_out.obj";
  std::ofstream out(file);
  for (int k = 0; k < 8; ++k)
    out << "v " << (k & 1 ? 0.03 : -0.03) << " " << (k & 2 ? 0.03 : -0.03) << " "
        << (k & 4 ? 0.0 : -0.02) << "\n";
  out << "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n";
  out.close();
  Rig rig(scene_of("[]", "[{mesh: " + file + "}]"));
  EXPECT_NEAR(rig.press(0.005).wrench.force.z(), kSpring * 0.005, 0.01);
}

/// Two flush blocks, each an object: the tool slides over their seam as over one block.
TEST(VirtualToolScene, SlidesOverTheSeamOfTwoObjects) {
  Rig rig(scene_of("[]", "[{mesh: " + plate(0.02) +
                             ", position: [-0.03, 0, 0], object: {name: left}}, {mesh: " +
                             plate(0.02) + ", position: [0.03, 0, 0], object: {name: right}}]"));
  rig.hold(at(0.012, -0.01), 250);
  for (int n = 0; n <= 100; ++n)
    rig(at(0.012 - 7e-5 * n, -0.01));
  for (int n = 0; n <= 400; ++n) {
    const SceneFrame frame = rig(at(0.005, -0.01 + 5e-5 * n));
    ASSERT_NEAR(frame.wrench.force.z(), kSpring * 0.005, 0.02) << n;
    ASSERT_LT(frame.wrench.force.head<2>().norm(), 0.02) << n;
  }
}

/// A cube of eight vertices with a ball over it, moved by whole voxels or scaled by a power of two.
struct BlockScene {
  double scale = 1.0;
  Vec3 origin = Vec3::Zero();
  std::string name;

  scene::Scene scene() const {
    const std::filesystem::path folder = std::filesystem::temp_directory_path();
    const std::string block = folder / ("voxtouch_block_" + name + ".obj");
    std::ofstream out(block);
    out.precision(17);
    for (int k = 0; k < 8; ++k) {
      const Vec3 v = origin + scale * Vec3(k & 1 ? 0x1p-5 : -0x1p-5, k & 2 ? 0x1p-5 : -0x1p-5,
                                           k & 4 ? 0.0 : -0x1p-6);
      out << "v " << v.x() << " " << v.y() << " " << v.z() << "\n";
    }
    out << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    out.close();
    return scene::parse_scene(
        fmt::format("scene: tool\nvoxel_size: {}\nstatic: [{{mesh: {}}}]\ndynamic: {{mesh: "
                    "sphere.obj, scale: {}}}\ncontact: {{rendering: virtual_tool}}\ncoupling: "
                    "{{design: auto}}\neffects: []\n",
                    scale * 0x1p-9, block, scale * 0x1p-7),
        std::string(VOXTOUCH_DEPLOY) + "/meshes/test.yaml");
  }
  ToolState hand(int n) const {
    ToolState tool;
    tool.pose.position = origin + scale * (Vec3(0, 0, 0x1p-6) + 0x1p-16 * Vec3(2 * n, n, -2 * n));
    return tool;
  }
};

TEST(VirtualToolScene, IsBitIdenticalMovedOrScaled) {
  const BlockScene here{1.0, Vec3::Zero(), "here"};
  Rig rig(here.scene());
  std::vector<SceneFrame> frames;
  for (int n = 0; n < 1600; ++n)  // over the edge
    frames.push_back(rig(here.hand(n)));
  EXPECT_GT(frames[500].wrench.force.norm(), 0.5);
  for (const BlockScene& other :
       {BlockScene{1.0, 0x1p-9 * Vec3(512, -1024, 256), "moved"},
        BlockScene{0.25, Vec3::Zero(), "small"}, BlockScene{8.0, Vec3::Zero(), "large"}}) {
    Rig again(other.scene());
    for (int n = 0; n < 1600; ++n) {
      const SceneFrame frame = again(other.hand(n)), &first = frames[static_cast<std::size_t>(n)];
      ASSERT_EQ(frame.wrench.force, Vec3(other.scale * first.wrench.force)) << other.name << n;
      ASSERT_EQ(frame.object.position, Vec3(other.origin + other.scale * first.object.position))
          << other.name << n;
    }
  }
}

}  // namespace
}  // namespace voxtouch::rendering
