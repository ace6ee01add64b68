/// Coulomb friction of the virtual tool.
#include <gtest/gtest.h>

#include "tests/unit/exact/rig.hpp"

namespace voxtouch::exact {
namespace {

constexpr double kFriction = 0.4;

/// A ball pressed 5 mm into a plate.
struct Pressed : Rig {
  Pressed() : Rig(test::ball(0.01, 3), test::box({-0.1, -0.1, -0.02}, {0.1, 0.1, 0.0})) {
    const Pose start{{0.01, 0.02, 0.0102}, Quat::Identity()};
    EXPECT_TRUE(virtual_tool.place(start, {&object_pose, 1}));
    hand = start;
    for (int k = 0; k < 60; ++k) {
      hand.position.z() = std::max(0.005, hand.position.z() - 1e-4);
      frame(hand, kFriction);
    }
  }
  Pose hand;
};

TEST(Friction, DraggedToolIsHeldByFrictionTimesForce) {
  Pressed rig;
  VirtualToolFrame frame;
  for (int k = 0; k < 300; ++k) {
    rig.hand.position.x() += 2e-5;
    frame = rig.frame(rig.hand, kFriction);
  }
  const double across = std::hypot(frame.shift.x(), frame.shift.y());
  EXPECT_NEAR(across / -frame.shift.z(), kFriction, 0.01);
  EXPECT_GT(frame.shift.x(), 0.0);
}

TEST(Friction, WithinTheConeTheToolSticksAndDoesNotCreep) {
  Pressed rig;
  const Pose stuck = rig.virtual_tool.pose();
  rig.hand.position.x() += 0.3 * (rig.virtual_tool.pose().position.z() - rig.hand.position.z());
  for (int k = 0; k < 500; ++k)
    rig.frame(rig.hand, kFriction);
  EXPECT_LT((rig.virtual_tool.pose().position - stuck.position).norm(), 1e-6);
  const Pose rested = rig.virtual_tool.pose();
  for (int k = 0; k < 100; ++k)
    EXPECT_EQ(rig.frame(rig.hand, kFriction).tool, rested);
}

TEST(Friction, PathThereAndBackDissipatesEnergy) {
  Pressed rig;
  double taken = 0.0, displacement = 0.0;
  Vec3 last = Vec3::Zero();
  for (int k = 0; k <= 1200; ++k) {
    Pose hand = rig.hand;
    hand.position.x() += 0.006 * std::sin(2.0 * std::numbers::pi * k / 600.0);
    const VirtualToolFrame frame = rig.frame(hand, kFriction);
    const Vec3 force = -frame.shift;  // on the hand, over k
    if (k > 600) {
      taken -= force.dot(hand.position - last);
      displacement += (hand.position - last).norm();
    }
    last = hand.position;
  }
  EXPECT_GT(taken, 0.5 * kFriction * 0.005 * displacement * 0.5);
  EXPECT_LT(taken, kFriction * 0.0052 * displacement);
}

TEST(Friction, TwistedPegFaceResistsRotation) {
  Rig rig(test::box({-.005, -.005, -.01}, {.005, .005, .01}),
          test::box({-0.1, -0.1, -0.02}, {0.1, 0.1, 0.0}));
  const Pose start{{0, 0, 0.0102}, Quat::Identity()};
  ASSERT_TRUE(rig.virtual_tool.place(start, {&rig.object_pose, 1}));
  Pose hand = start;
  for (int k = 0; k < 100; ++k) {
    hand.position.z() = std::max(0.006, hand.position.z() - 1e-4);
    rig.frame(hand, kFriction);
  }
  hand.orientation = turned(0.02, Vec3::UnitZ());
  VirtualToolFrame frame;
  for (int k = 0; k < 50; ++k)
    frame = rig.frame(hand, kFriction);
  EXPECT_NEAR(frame.rotation.z(), 0.02, 2e-3);  // it sticks
  for (int k = 0; k < 50; ++k)
    frame = rig.frame(hand, 0.0);
  EXPECT_LT(std::abs(frame.rotation.z()), 1e-4);
}

}  // namespace
}  // namespace voxtouch::exact
