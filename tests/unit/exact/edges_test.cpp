/// Sharp edges that meet crosswise stop each other.
#include <gtest/gtest.h>

#include "core/exact/limits.hpp"
#include "tests/unit/exact/rig.hpp"

namespace voxtouch::exact {
namespace {

TEST(Edges, CrossedEdgesTouchAtTheirLinesIntersection) {
  for (const double degrees : {10.0, 30.0, 60.0, 90.0, 120.0, 150.0}) {
    const mesh::TriangleMesh wedge = test::wedge(degrees * kDegree, 0.01, 0.02);
    const Quat upside_down =
        turned(std::numbers::pi, Vec3::UnitX()) * turned(0.5 * std::numbers::pi, Vec3::UnitZ());
    Rig rig(wedge, wedge);
    const Pose start{{0.001, 0.002, 0.003}, upside_down};
    const Pose in{{0.001, 0.002, -0.003}, upside_down};
    ASSERT_TRUE(rig.virtual_tool.place(start, {&rig.object_pose, 1})) << degrees;
    rig.lead(start, in, 60);
    // The lever makes the tool tilt about neither edge: both lines meet below the tool's origin,
    // off by 2 mm.
    const VirtualToolFrame frame = rig.rest(in, 5);
    EXPECT_TRUE(frame.constrained) << degrees;
    EXPECT_FALSE(rig.intersects()) << degrees;
    EXPECT_EQ(frame.rows, 1u) << degrees;
    const Vec3 edge = frame.tool.orientation * Vec3::UnitY();
    const Vec3 across = Vec3::UnitY().cross(edge).normalized();
    EXPECT_NEAR(std::abs(across.dot(frame.tool.position)), limits::kMarginM, 2e-8) << degrees;
    EXPECT_LT(std::min(angle_between(frame.contact_normal, across),
                       angle_between(frame.contact_normal, -across)),
              1e-4);
  }
}

TEST(Edges, BallPulledOverAnEdgeLeavesWithoutASnag) {
  Rig rig(test::ball(0.01, 3), test::box({-0.05, -0.05, -0.05}, {0.0, 0.05, 0.0}));
  const Pose start{{-0.02, 0.001, 0.011}, Quat::Identity()};
  ASSERT_TRUE(rig.virtual_tool.place(start, {&rig.object_pose, 1}));
  Pose pressed = start;
  pressed.position.z() = 0.007;
  rig.lead(start, pressed, 40);
  VirtualToolFrame frame;
  for (int k = 0; k < 800; ++k) {
    pressed.position.x() += 5e-5;
    frame = rig.frame(pressed);
    ASSERT_LT(frame.shift.norm(), 0.0031) << k;
  }
  EXPECT_EQ(frame.tool, pressed);
  EXPECT_FALSE(rig.intersects());
}

}  // namespace
}  // namespace voxtouch::exact
