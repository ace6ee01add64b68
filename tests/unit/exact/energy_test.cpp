/// The spring generates no energy on closed loops of the hand; at yielding edges it dissipates
/// some.
#include <gtest/gtest.h>

#include "tests/unit/exact/rig.hpp"

namespace voxtouch::exact {
namespace {

/// Energy over k [m^2] that the hand gets on its second round, and force times displacement of that
/// round [m^2].
struct Round {
  double given = 0.0, moved = 0.0;
};

template <class Hand>
Round second_round(Rig& rig, const Hand& hand, int frames) {
  Round round;
  Pose last = hand(0);
  Vec3 last_force = Vec3::Zero(), last_torque = Vec3::Zero();
  for (int k = 0; k <= 2 * frames; ++k) {
    const Pose now = hand(k % frames);
    const VirtualToolFrame frame = rig.frame(now);
    const Vec3 force = -frame.shift, torque = -frame.lever_m * frame.lever_m * frame.rotation;
    if (k > frames) {
      const Vec3 shift = now.position - last.position;
      const Vec3 turn = 2.0 * (now.orientation * last.orientation.conjugate()).vec();
      round.given += 0.5 * ((force + last_force).dot(shift) + (torque + last_torque).dot(turn));
      round.moved += force.norm() * shift.norm() + torque.norm() * turn.norm();
    }
    last = now;
    last_force = force;
    last_torque = torque;
  }
  return round;
}

TEST(Energy, SlidingRoundOnAPlaneGivesNone) {
  Rig rig(test::ball(0.01, 3), test::box({-0.1, -0.1, -0.02}, {0.1, 0.1, 0.0}));
  ASSERT_TRUE(rig.virtual_tool.place({{0.02, 0, 0.0102}, Quat::Identity()}, {&rig.object_pose, 1}));
  const auto hand = [](int k) {
    const double angle = 2.0 * std::numbers::pi * k / 1000.0;
    return Pose{{0.02 * std::cos(angle), 0.02 * std::sin(angle), 0.007 + 0.001 * std::sin(angle)},
                Quat::Identity()};
  };
  const Round round = second_round(rig, hand, 1000);
  EXPECT_LE(round.given, 1e-4 * round.moved);
}

TEST(Energy, SlidingRoundACylinderGivesNone) {
  Rig rig(test::ball(0.01, 3), test::prism(test::circle(0.02, 96), -0.05, 0.05));
  ASSERT_TRUE(rig.virtual_tool.place({{0.0305, 0, 0}, Quat::Identity()}, {&rig.object_pose, 1}));
  const auto hand = [](int k) {
    const double angle = 2.0 * std::numbers::pi * k / 2500.0;
    return Pose{{0.027 * std::cos(angle), 0.027 * std::sin(angle), 0.005 * std::sin(angle)},
                Quat::Identity()};
  };
  const Round round = second_round(rig, hand, 2500);
  EXPECT_LE(round.given, 1e-4 * round.moved);
}

TEST(Energy, PinGuidedAroundItsHoleGivesNone) {
  Rig rig(test::prism(test::circle(0.005, 72), -0.015, 0.015),
          test::block_with_hole(test::circle(0.0052, 72), 0.02, -0.02, 0.02));
  ASSERT_TRUE(rig.virtual_tool.place({}, {&rig.object_pose, 1}));
  const auto hand = [](int k) {
    const double angle = 2.0 * std::numbers::pi * k / 1000.0;
    return Pose{{0.001 * std::sin(angle), 0.001 - 0.001 * std::cos(angle), 0.0},
                turned(0.03 * std::sin(2 * angle), {1, std::sin(angle), 0.2})};
  };
  const Round round = second_round(rig, hand, 1000);
  EXPECT_LE(round.given, 1e-4 * round.moved);
}

}  // namespace
}  // namespace voxtouch::exact
