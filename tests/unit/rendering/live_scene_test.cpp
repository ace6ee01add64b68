// One scene taking the place of another while the tool is in contact.
#include "core/rendering/live_scene.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "core/scene/scene_file.hpp"

namespace voxtouch::rendering {
namespace {

std::unique_ptr<BuiltScene> plane(double voxel_size_m, const std::string& model = "adapted") {
  scene::Scene scene = scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
  scene.voxel_size_m = voxel_size_m;
  scene.contact.model = model;
  return build_scene(scene, serial_for());
}

/// Pressed into the plane, resting.
ToolState pressed() {
  ToolState tool;
  tool.pose.position = Vec3(0.003, 0.002, 0.0085);
  return tool;
}

TEST(LiveScene, RendersItsOnlySceneBitForBit) {
  const auto one = plane(0.002), same = plane(0.002);
  LiveScene live(*one);
  for (int i = 0; i < 20; ++i) {
    const SceneFrame a = live.render(pressed(), 0.001 * i),
                     b = same->scene_renderer().render(pressed(), 0.001 * i);
    ASSERT_EQ(a.wrench.force, b.wrench.force);
    ASSERT_EQ(a.stiffness, b.stiffness);
  }
  EXPECT_EQ(live.retired(), nullptr);
}

TEST(LiveScene, SwitchesScenesIn200MillisecondsWithoutAStep) {
  const auto old_scene = plane(0.002), new_scene = plane(0.001);
  LiveScene live(*old_scene);
  Vec3 last = live.render(pressed(), 0.0).wrench.force;
  const Vec3 before = last;
  live.swap_to(*new_scene);
  const Vec3 after = plane(0.001)->scene_renderer().render(pressed(), 0.0).wrench.force;
  const double displacement = (after - before).norm();
  ASSERT_GT(displacement, 0.5 * before.norm()) << "the two must differ, or nothing is shown";
  int samples = 0;
  for (; live.fading(); ++samples) {
    ASSERT_LT(samples, 250);
    ASSERT_EQ(live.retired(), nullptr) << "it still is rendered";
    const SceneFrame frame = live.render(pressed(), 0.001 * (samples + 1));
    ASSERT_LE((frame.wrench.force - last).norm(), 1.001 * displacement * 0.001 / LiveScene::kFadeS);
    const Eigen::SelfAdjointEigenSolver<Mat6> eigen(frame.stiffness);
    ASSERT_GT(eigen.eigenvalues().minCoeff(), -1e-9 * eigen.eigenvalues().maxCoeff());
    const Mat3 translation = frame.stiffness.topLeftCorner<3, 3>();
    ASSERT_LE(translation.operatorNorm(), frame.stiffness_bound_n_per_m * (1 + 1e-12));
    last = frame.wrench.force;
  }
  EXPECT_NEAR(samples, 200, 1);
  EXPECT_EQ(last, after) << "the new scene alone, bit for bit";
  EXPECT_EQ(&live.dominant(), new_scene.get());
  EXPECT_EQ(live.retired(), old_scene.get());
  EXPECT_EQ(live.retired(), nullptr) << "once";
}

TEST(LiveScene, ReportsTheSceneWithMoreWeight) {
  const auto old_scene = plane(0.002), new_scene = plane(0.001);
  LiveScene live(*old_scene);
  live.render(pressed(), 0.0);
  live.swap_to(*new_scene);
  for (int i = 1; i <= 99; ++i)
    live.render(pressed(), 0.001 * i);
  EXPECT_EQ(&live.dominant(), old_scene.get());
  for (int i = 100; i <= 110; ++i)
    live.render(pressed(), 0.001 * i);
  EXPECT_EQ(&live.dominant(), new_scene.get());
}

TEST(LiveScene, AGapInTimeIsNoJumpOfTheForce) {
  const auto old_scene = plane(0.002), new_scene = plane(0.001);
  LiveScene live(*old_scene);
  const Vec3 before = live.render(pressed(), 0.0).wrench.force;
  live.swap_to(*new_scene);
  const Vec3 later = live.render(pressed(), 3.0).wrench.force;
  EXPECT_LT((later - before).norm(), 0.02 * before.norm()) << "three seconds without a sample";
}

TEST(LiveScene, ANewSessionEndsAFadeAndGivesTheOldSceneBack) {
  const auto old_scene = plane(0.002), new_scene = plane(0.001);
  LiveScene live(*old_scene);
  live.render(pressed(), 0.0);
  live.swap_to(*new_scene);
  live.render(pressed(), 0.001);
  live.reset();
  EXPECT_FALSE(live.fading());
  EXPECT_EQ(live.retired(), old_scene.get());
  EXPECT_EQ(live.render(pressed(), 0.0).wrench.force,
            plane(0.001)->scene_renderer().render(pressed(), 0.0).wrench.force);
}

}  // namespace
}  // namespace voxtouch::rendering
