/// A pin of many sides in a blind hole of as many: most pairs are near, few touch, and the pin
/// slides past all of them.
#include <gtest/gtest.h>

#include "core/exact/limits.hpp"
#include "tests/unit/exact/rig.hpp"

namespace voxtouch::exact {
namespace {

constexpr int kSides = 384;
constexpr double kRadius = 0.005, kHalf = 0.015, kDeep = 0.02, kLever = 0.015, kStiffness = 300.0;

/// A round block with its mouth at z = 0: one closed mesh with walls at `radius` from the axis.
mesh::TriangleMesh blind_hole(double radius) {
  constexpr double kOuter = 0.02, kFloor = 0.01;
  mesh::TriangleMesh mesh;
  const double corner = radius / std::cos(std::numbers::pi / kSides);
  for (std::uint32_t n = 0; n < kSides; ++n) {
    const double angle = 2.0 * std::numbers::pi * n / kSides;
    const Vec3 to(std::cos(angle), std::sin(angle), 0.0);
    mesh.vertices.push_back(kOuter * to - (kDeep + kFloor) * Vec3::UnitZ());
    mesh.vertices.push_back(kOuter * to);
    mesh.vertices.push_back(corner * to);
    mesh.vertices.push_back(corner * to - kDeep * Vec3::UnitZ());
  }
  mesh.vertices.emplace_back(0.0, 0.0, -kDeep);
  mesh.vertices.emplace_back(0.0, 0.0, -kDeep - kFloor);
  for (std::uint32_t n = 0; n < kSides; ++n) {
    const std::uint32_t a = 4 * n, b = 4 * ((n + 1) % kSides);
    for (std::uint32_t ring = 0; ring < 3; ++ring) {
      mesh.triangles.push_back({a + ring, b + ring, b + ring + 1});
      mesh.triangles.push_back({a + ring, b + ring + 1, a + ring + 1});
    }
    mesh.triangles.push_back({a + 3, b + 3, 4 * kSides});
    mesh.triangles.push_back({b, a, 4 * kSides + 1});
  }
  return mesh;
}

Rig pin_over_hole(double clearance) {
  return Rig(test::prism(test::circle(kRadius, kSides), -kHalf, kHalf),
             blind_hole(kRadius + clearance), {.lever_m = kLever});
}

struct PinCase {
  double clearance, drag_n;
  bool turned;
};

class Pins : public ::testing::TestWithParam<PinCase> {};

/// 50 mm/s, aligned to 8 mm deep, then the hand 1.7 mm aside or rotated by 2.9 degrees.
TEST_P(Pins, ComeToTheFloorOfTheirHole) {
  const PinCase& pin = GetParam();
  Rig rig = pin_over_hole(pin.clearance);
  double z = kHalf + 0.003, drag = 0.0;
  ASSERT_TRUE(rig.virtual_tool.place({Vec3(0, 0, z), Quat::Identity()}, {&rig.object_pose, 1}));
  const auto go = [&](double to, const Vec3& aside, const Quat& turn) {
    for (; z > to; z -= 5e-5) {
      const VirtualToolFrame frame = rig.frame({aside + Vec3(0, 0, z), turn});
      if (z > kHalf - kDeep + 2e-3)
        drag = std::max(drag, std::abs(frame.wrench(kStiffness).force.z()));
    }
  };
  go(kHalf - 0.008, Vec3::Zero(), Quat::Identity());
  const Quat turn = pin.turned ? turned(2.9 * kDegree, Vec3::UnitX()) : Quat::Identity();
  const Vec3 aside = pin.turned ? Vec3::Zero() : Vec3(1.7e-3, 0, 0);
  rig.lead({Vec3(0, 0, z), Quat::Identity()}, {aside + Vec3(0, 0, z), turn}, 50);
  go(kHalf - kDeep - 0.004, aside, turn);
  const VirtualToolFrame frame = rig.rest({aside + Vec3(0, 0, z), turn}, 200);
  EXPECT_NEAR(frame.tool.position.z(), kHalf - kDeep + limits::kMarginM, 1e-8);
  EXPECT_FALSE(frame.not_converged);
  EXPECT_LT(drag, pin.drag_n);
  EXPECT_FALSE(rig.intersects());
}

INSTANTIATE_TEST_SUITE_P(Clearances, Pins,
                         ::testing::Values(PinCase{2e-4, 0.1, false}, PinCase{2e-4, 0.1, true},
                                           PinCase{1e-4, 0.5, false}, PinCase{1e-4, 0.5, true}));

/// The torque of a pin at the mouth's edge and at its lower rim: the play is clearance, facets and
/// margins, then the spring.
TEST(Pins, GiveTheTorqueOfTheirPlayWithoutSteps) {
  constexpr double kClearance = 2e-4, kTurn = 12.0 * kDegree, kIn = 0.015;
  constexpr int kFrames = 2000;
  Rig rig = pin_over_hole(kClearance);
  const Vec3 axis(std::cos(0.7), std::sin(0.7), 0.0);
  double z = kHalf + 0.003;
  ASSERT_TRUE(rig.virtual_tool.place({Vec3(0, 0, z), Quat::Identity()}, {&rig.object_pose, 1}));
  for (; z > kHalf - kIn; z -= 5e-5)
    rig.frame({Vec3(0, 0, z), Quat::Identity()});
  // In contact at the lower rim and the mouth, kIn apart: the rim's wall and the mouth's are 2
  // (radius + clearance) apart across the tilted pin, 2 radius cos + depth sin.
  const double width = 2.0 * (kRadius + kClearance - limits::kMarginM);
  const double play =
      std::asin(width / std::hypot(2.0 * kRadius, kIn)) - std::atan2(2.0 * kRadius, kIn);
  double last = 0.0, step = 0.0;
  const double most = kStiffness * kLever * kLever * (kTurn - play);
  for (int n = 1; n <= kFrames; ++n) {
    const VirtualToolFrame frame = rig.frame({Vec3(0, 0, z), turned(kTurn * n / kFrames, axis)});
    const double torque = -frame.wrench(kStiffness).torque.dot(axis);
    step = std::max(step, std::abs(torque - last) / most);
    last = torque;
  }
  EXPECT_NEAR(last, most, 0.01 * most);
  EXPECT_LT(step, 0.002);
}

}  // namespace
}  // namespace voxtouch::exact
