/// Pins, crosses and gears in holes with little clearance, against closed forms.
#include <gtest/gtest.h>

#include <random>

#include "core/exact/limits.hpp"
#include "tests/unit/exact/rig.hpp"

namespace voxtouch::exact {
namespace {

constexpr double kMargin = limits::kMarginM;
constexpr double kLength = 0.01, kWidth = 0.003;  // of the cross' arms

struct Peg {
  const char* name;
  double clearance;
  mesh::TriangleMesh peg, hole;
};

std::vector<Peg> pegs() {
  std::vector<Peg> out;
  for (const double c : {2e-4, 1e-4, 5e-5}) {
    out.push_back({"cross", c, test::prism(test::cross(kLength, kWidth, 0.0), -0.01, 0.01),
                   test::block_with_hole(test::cross(kLength, kWidth, c), 0.02, -0.02, 0.02)});
    out.push_back({"gear", c, test::prism(test::gear(12, 0.008, 0.01, 0.0), -0.01, 0.01),
                   test::block_with_hole(test::gear(12, 0.008, 0.01, c), 0.02, -0.02, 0.02)});
    out.push_back({"pin", c, test::prism(test::circle(0.005, 144), -0.015, 0.015),
                   test::block_with_hole(test::circle(0.005 + c, 144), 0.02, -0.02, 0.02)});
  }
  return out;
}

TEST(Holes, AShiftedCrossIsHeldByTheClosedForm) {
  for (const double c : {2e-4, 5e-5}) {
    for (int k = 0; k < 12; ++k) {
      Rig rig(test::prism(test::cross(kLength, kWidth, 0.0), -0.01, 0.01),
              test::block_with_hole(test::cross(kLength, kWidth, c), 0.02, -0.02, 0.02));
      ASSERT_TRUE(rig.virtual_tool.place({}, {&rig.object_pose, 1}));
      const double angle = 0.1 + 0.5 * k;
      const Pose hand{Vec3(std::cos(angle), std::sin(angle), 0.0) * 1e-3, Quat::Identity()};
      rig.lead({}, hand, 20);
      const VirtualToolFrame frame = rig.rest(hand, 100);
      const double most = c - kMargin;
      const Vec3 held = hand.position.cwiseMax(-most).cwiseMin(most);
      EXPECT_NEAR((frame.tool.position - held).norm(), 0.0, 2e-9);
      EXPECT_LT(angle_between(frame.shift, hand.position - held), 1e-5);
      EXPECT_LT(frame.rotation.norm(), 1e-6);
    }
  }
}

TEST(Holes, RotatedCrossIsHeldByTheClosedForm) {
  for (const double c : {2e-4, 5e-5}) {
    for (const double displacement : {0.1, -0.1}) {
      Rig rig(test::prism(test::cross(kLength, kWidth, 0.0), -0.01, 0.01),
              test::block_with_hole(test::cross(kLength, kWidth, c), 0.02, -0.02, 0.02));
      ASSERT_TRUE(rig.virtual_tool.place({}, {&rig.object_pose, 1}));
      const Pose hand{Vec3::Zero(), turned(displacement, Vec3::UnitZ())};
      rig.lead({}, hand, 30);
      const VirtualToolFrame frame = rig.rest(hand, 200);
      // The arm's corner (length, width) meets the wall: length sin + width cos = width + clearance
      // - margin.
      const double radius = std::hypot(kLength, kWidth);
      const double held = std::asin((kWidth + c - kMargin) / radius) - std::atan2(kWidth, kLength);
      const Vec3 rotation = 2.0 * frame.tool.orientation.vec();
      EXPECT_NEAR(std::abs(rotation.z()), held, 1e-3 * held);
      EXPECT_LT(angle_between(frame.rotation, {0, 0, displacement}), 0.1 * kDegree);
      EXPECT_LT(frame.tool.position.norm(), 1e-6);
    }
  }
}

TEST(Holes, AShiftedPinIsHeldWithinHalfItsFacetsAngle) {
  for (const double c : {2e-4, 5e-5}) {
    for (int k = 0; k < 8; ++k) {
      Rig rig(test::prism(test::circle(0.005, 144), -0.015, 0.015),
              test::block_with_hole(test::circle(0.005 + c, 144), 0.02, -0.02, 0.02));
      ASSERT_TRUE(rig.virtual_tool.place({}, {&rig.object_pose, 1}));
      const double angle = 0.1 + 0.77 * k;
      const Pose hand{Vec3(std::cos(angle), std::sin(angle), 0.0) * 1e-3, Quat::Identity()};
      rig.lead({}, hand, 20);
      const VirtualToolFrame frame = rig.rest(hand, 100);
      EXPECT_LT(angle_between(frame.shift, hand.position), 1.25 * kDegree);
      EXPECT_NEAR(frame.shift.norm(), 1e-3 - (c - kMargin), 0.01 * 1e-3);
      EXPECT_FALSE(frame.not_converged);
      EXPECT_FALSE(rig.intersects());
    }
  }
}

TEST(Holes, ATiltedPinIsHeldAtBothEnds) {
  constexpr double kClearance = 1e-4, kHalf = 0.015;
  Rig rig(test::prism(test::circle(0.005, 144), -kHalf, kHalf),
          test::block_with_hole(test::circle(0.005 + kClearance, 144), 0.02, -0.02, 0.02));
  ASSERT_TRUE(rig.virtual_tool.place({}, {&rig.object_pose, 1}));
  const Pose hand{Vec3::Zero(), turned(0.1, Vec3::UnitX())};
  rig.lead({}, hand, 30);
  const VirtualToolFrame frame = rig.rest(hand, 200);
  // radius cos + half sin = radius + clearance - margin, in the plane of the tilt.
  const double length = std::hypot(0.005, kHalf);
  const double held = std::asin((0.005 + kClearance - kMargin) / length) - std::atan2(0.005, kHalf);
  EXPECT_NEAR(2.0 * frame.tool.orientation.vec().x(), held, 0.01 * held);
  EXPECT_LT(angle_between(frame.rotation, Vec3::UnitX()), 1.25 * kDegree);
  EXPECT_FALSE(rig.intersects());
}

TEST(Holes, AHandAtRestHasAToolAtRest) {
  for (const Peg& peg : pegs()) {
    Rig rig(peg.peg, peg.hole);
    ASSERT_TRUE(rig.virtual_tool.place({}, {&rig.object_pose, 1}));
    const Pose hand{Vec3(4e-4, -7e-4, 1e-3), turned(0.05, {1, 2, 3})};
    rig.lead({}, hand, 30);
    const VirtualToolFrame rested = rig.rest(hand, 200);
    EXPECT_TRUE(rested.constrained);
    for (int k = 0; k < 20; ++k) {
      const VirtualToolFrame frame = rig.frame(hand);
      EXPECT_EQ(frame.tool, rested.tool) << peg.name << ' ' << peg.clearance;
      EXPECT_FALSE(frame.not_converged) << peg.name << ' ' << peg.clearance;
    }
    EXPECT_FALSE(rig.intersects());
  }
}

}  // namespace
}  // namespace voxtouch::exact
