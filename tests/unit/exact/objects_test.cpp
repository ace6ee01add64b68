/// Several objects, and objects that move.
#include <gtest/gtest.h>

#include "core/exact/limits.hpp"
#include "tests/unit/exact/rig.hpp"

namespace voxtouch::exact {
namespace {

struct TwoObjects {
  TwoObjects(const mesh::TriangleMesh& tool_mesh, const mesh::TriangleMesh& a,
             const mesh::TriangleMesh& b)
      : tool(tool_mesh),
        first(a),
        second(b),
        bodies{&first, &second},
        virtual_tool(tool, bodies, {}) {}
  VirtualToolFrame frame(const Pose& hand) { return virtual_tool.frame({hand, 1e-3, 0.0}, poses); }

  ToolBody tool;
  ObjectBody first, second;
  std::array<const ObjectBody*, 2> bodies;
  std::array<Pose, 2> poses;
  VirtualTool virtual_tool;
};

const mesh::TriangleMesh kPlate = test::box({-0.1, -0.1, -0.02}, {0.1, 0.1, 0.0});

TEST(Objects, InACornerOfTwoEachPushesWithItsOwnForce) {
  TwoObjects rig(test::ball(0.01, 3), kPlate, kPlate);
  rig.poses[1].orientation =
      turned(0.5 * std::numbers::pi, Vec3::UnitY());  // its upper side faces +x
  Pose hand{{0.03, 0.0, 0.03}, Quat::Identity()};
  ASSERT_TRUE(rig.virtual_tool.place(hand, rig.poses));
  VirtualToolFrame frame;
  for (int k = 0; k < 400; ++k) {
    hand.position -= Vec3(6e-5, 0.0, 7e-5);
    frame = rig.frame(hand);
  }
  for (int k = 0; k < 50; ++k)
    frame = rig.frame(hand);
  EXPECT_NEAR(frame.shift.x(), hand.position.x() - 0.01, 1e-4);
  EXPECT_NEAR(frame.shift.z(), hand.position.z() - 0.01, 1e-4);
  const auto forces = rig.virtual_tool.contact_forces();
  EXPECT_NEAR((forces[0].force - Vec3(0, 0, -frame.shift.z())).norm(), 0.0, 1e-7);
  EXPECT_NEAR((forces[1].force - Vec3(-frame.shift.x(), 0, 0)).norm(), 0.0, 1e-7);
}

/// A block that fills a slot touches both walls, whichever pushes; on one plate it touches one
/// side.
TEST(Objects, OppositeWallsOfASlotHaveNoCoherence) {
  for (const double clearance : {4e-6, 2e-3}) {
    TwoObjects rig(test::box({-0.02, -0.02, 0.0}, {0.02, 0.02, 0.03}), kPlate, kPlate);
    rig.poses[1] = {{0.0, 0.0, 0.03 + clearance}, turned(std::numbers::pi, Vec3::UnitX())};
    Pose hand{{0.0, 0.0, 0.5 * clearance}, Quat::Identity()};
    ASSERT_TRUE(rig.virtual_tool.place(hand, rig.poses));
    for (const double z : {-1e-3, 1e-3 + clearance}) {
      hand.position.z() = z;
      VirtualToolFrame frame;
      for (int k = 0; k < 50; ++k)
        frame = rig.frame(hand);
      ASSERT_TRUE(frame.constrained);
      if (clearance < 1e-5)
        EXPECT_LT(frame.coherence, 0.2) << z;
      else
        EXPECT_NEAR(frame.coherence, 1.0, 1e-9) << z;
    }
  }
}

/// Two flush blocks as one body: nothing is displayed of their seam, and each reports its own
/// force.
TEST(Objects, OfOneBodyReportTheirOwnForces) {
  const mesh::TriangleMesh left = test::box({-0.1, -0.1, -0.02}, {0.0, 0.1, 0.0});
  const mesh::TriangleMesh right = test::box({0.0, -0.12, -0.03}, {0.1, 0.12, 0.0});
  std::vector<std::uint32_t> owners(left.triangles.size(), 0);
  owners.resize(left.triangles.size() + right.triangles.size(), 1);
  const ToolBody tool(test::ball(0.01, 3));
  const ObjectBody both(test::joined(left, right), owners);
  const ObjectBody* const bodies[] = {&both};
  VirtualTool virtual_tool(tool, bodies, {});
  const Pose rest;
  Pose hand{{-0.02, 0.0, 0.011}, Quat::Identity()};
  ASSERT_TRUE(virtual_tool.place(hand, {&rest, 1}));
  ASSERT_EQ(virtual_tool.contact_forces().size(), 2U);
  for (int k = 0; k < 100; ++k) {
    hand.position.z() -= 6e-5;
    virtual_tool.frame({hand, 1e-3, 0.0}, {&rest, 1});
  }
  for (int k = 0; k <= 400; ++k) {
    hand.position.x() = -0.02 + 1e-4 * k;
    const VirtualToolFrame frame = virtual_tool.frame({hand, 1e-3, 0.0}, {&rest, 1});
    ASSERT_LT(frame.shift.head<2>().norm(), 1e-5) << k;
    const Vec3 on_left = virtual_tool.contact_forces()[0].force;
    const Vec3 on_right = virtual_tool.contact_forces()[1].force;
    ASSERT_NEAR((on_left + on_right).z(), -frame.shift.z(), 1e-9) << k;
    if (k < 190 || k > 210) {
      ASSERT_TRUE((k < 190 ? on_right : on_left).isZero(0.0)) << k;
    }
  }
  EXPECT_THROW(ObjectBody(left, owners), std::invalid_argument);
}

/// A plate that moves up and down by 10 mm at half a metre per second, under a hand at rest.
TEST(Objects, FastObjectIsFollowedWithoutDelay) {
  for (const bool ball : {true, false}) {
    const mesh::TriangleMesh tool =
        ball ? test::ball(0.01, 3) : test::box({-.005, -.005, -.01}, {.005, .005, .01});
    Rig rig(tool, kPlate);
    const Pose hand{{0.01, 0.02, 0.0}, turned(0.1, {1, 0.5, 0.2})};
    rig.object_pose.position.z() = -0.03;
    ASSERT_TRUE(rig.virtual_tool.place(hand, {&rig.object_pose, 1}));
    double z = -0.03, speed = 5e-4;
    for (int k = 0; k < 2000; ++k) {
      z += speed;
      if (z > 0.01 || z < -0.02)
        speed = -speed;
      if (z < -0.02)
        z = -0.02;
      rig.object_pose.position.z() = z;
      const VirtualToolFrame frame = rig.frame(hand);
      ASSERT_EQ(frame.object_delay_m, 0.0) << k << ' ' << ball;
      ASSERT_FALSE(frame.cut_short) << k;
      if (k % 10 == 0) {
        ASSERT_FALSE(rig.intersects()) << k;
      }
    }
  }
}

TEST(Objects, PinchedToolPassesOnlyFarObjects) {
  TwoObjects rig(test::ball(0.01, 3), kPlate, kPlate);
  rig.poses[1] = {{0, 0, 0.025},
                  turned(std::numbers::pi, Vec3::UnitX())};  // a ceiling that moves down
  const Pose hand{{0, 0, 0.0115}, Quat::Identity()};
  ASSERT_TRUE(rig.virtual_tool.place(hand, rig.poses));
  bool lost = false;
  for (int k = 0; k < 200 && !lost; ++k) {
    rig.poses[1].position.z() -= 1e-4;
    const VirtualToolFrame frame = rig.frame(hand);
    lost = frame.passed_through;
    const double height = frame.tool.position.z();
    if (!lost) {
      ASSERT_GT(height, 0.009);
      ASSERT_LT(height, 0.0125);
    }
  }
  EXPECT_TRUE(lost);
  EXPECT_LT(rig.poses[1].position.z(), 0.0205 - limits::kMaxObjectDelayM + 1e-3);
}

}  // namespace
}  // namespace voxtouch::exact
