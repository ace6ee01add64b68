#include "core/exact/start_check.hpp"

#include <gtest/gtest.h>

#include "tests/unit/exact/rig.hpp"

namespace voxtouch::exact {
namespace {

const mesh::TriangleMesh kBlock = test::box({-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1});

bool starts_at(const mesh::TriangleMesh& tool, const mesh::TriangleMesh& object, const Vec3& at) {
  Rig rig(tool, object);
  return rig.virtual_tool.place({at, Quat::Identity()}, {&rig.object_pose, 1});
}

TEST(StartCheck, ATouchOrAnInsideIsNoStart) {
  const mesh::TriangleMesh ball = test::ball(0.01, 2);
  EXPECT_FALSE(starts_at(ball, kBlock, {0, 0, 0}));      // wholly inside, no surface met
  EXPECT_FALSE(starts_at(ball, kBlock, {0, 0, 0.095}));  // half in
  EXPECT_TRUE(starts_at(ball, kBlock, {0, 0, 0.12}));
  EXPECT_FALSE(starts_at(test::ball(0.5, 2), kBlock, {0, 0, 0}));  // the object is inside the tool
}

TEST(StartCheck, ABallOverAThinSheetIsNoStart) {
  const mesh::TriangleMesh sheet = test::sheet(0.2, 4);
  EXPECT_FALSE(starts_at(test::ball(0.01, 2), sheet, {0.01, 0.0, 0.001}));
  EXPECT_TRUE(starts_at(test::ball(0.01, 2), sheet, {0.01, 0.0, 0.011}));
  EXPECT_TRUE(starts_at(test::ball(0.01, 2), sheet, {0.01, 0.0, -0.011}));
}

TEST(StartCheck, InvertedRoomIsFree) {
  EXPECT_TRUE(starts_at(test::ball(0.01, 2), test::turned_inside_out(kBlock), {0, 0, 0}));
  EXPECT_TRUE(starts_at(
      test::ball(0.01, 2),
      test::joined(kBlock, test::turned_inside_out(test::box({-.05, -.05, -.05}, {.05, .05, .05}))),
      {0, 0, 0}));
}

TEST(StartCheck, NoForceUntilTheHandIsInTheOpenAndThenItFadesIn) {
  Rig rig(test::ball(0.01, 2), kBlock);
  Pose hand{{0, 0, 0.105}, Quat::Identity()};
  const VirtualToolFrame inside = rig.rest(hand, 20);
  EXPECT_TRUE(inside.not_initialised);
  EXPECT_TRUE(inside.wrench(300.0).zero());
  hand.position.z() = 0.1101;
  const VirtualToolFrame outside = rig.rest(hand, 20);
  EXPECT_FALSE(outside.not_initialised);
  EXPECT_EQ(outside.tool, hand);
  hand.position.z() = 0.105;
  const VirtualToolFrame pressed = rig.rest(hand, 20);
  EXPECT_TRUE(pressed.constrained);
  EXPECT_LT(pressed.ratio, 0.25);
  EXPECT_EQ(rig.rest(hand, 300).ratio, 1.0);
}

TEST(StartCheck, IsSpreadOverFramesByTheLimitOfWork) {
  VirtualToolOptions options;
  options.max_work = 300;
  Rig rig(test::ball(0.01, 3), test::bowl(0.03, 0.034, 48, 12), options);
  const Pose hand{{0.005, 0.0, -0.01}, Quat::Identity()};
  int frames = 0;
  while (rig.frame(hand).not_initialised && ++frames < 1000) {
  }
  EXPECT_GT(frames, 1);
  EXPECT_LT(frames, 200);
}

}  // namespace
}  // namespace voxtouch::exact
