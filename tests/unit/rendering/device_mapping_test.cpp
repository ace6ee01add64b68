#include "core/rendering/device_mapping.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <random>

namespace voxtouch::rendering {
namespace {

class Random {
 public:
  double u() { return uniform_(engine_); }
  Vec3 vec() { return {u(), u(), u()}; }
  Quat quat() { return Quat(u(), u(), u(), u()).normalized(); }
  Pose pose() { return {vec(), quat()}; }
  scene::WorkspaceMapping spec() {
    return {0.2 + 2 * std::abs(u()), 0.1 + std::abs(u()), pose(), pose(), 2U};
  }

 private:
  std::mt19937_64 engine_{77};
  std::uniform_real_distribution<double> uniform_{-1, 1};
};

double distance(const Pose& a, const Pose& b) {
  return (a.position - b.position).norm() +
         (a.orientation.toRotationMatrix() - b.orientation.toRotationMatrix()).norm();
}

/// The pose after `dt` seconds of a twist in the pose's outer frame.
Pose moved(const Pose& p, const Twist& v, double dt) {
  const double angle = v.angular.norm() * dt;
  const Quat turn =
      angle > 0 ? Quat(Eigen::AngleAxisd(angle, v.angular.normalized())) : Quat::Identity();
  return {p.position + dt * v.linear, turn * p.orientation};
}

TEST(DeviceMapping, TipGoesThroughBaseScaleAndToolOffset) {
  Random r;
  for (int n = 0; n < 50; ++n) {
    const scene::WorkspaceMapping spec = r.spec();
    const Pose tip = r.pose();
    DeviceMapping mapping(spec);
    const Pose expected =
        spec.pose_WD * Pose{spec.position_scale * tip.position, tip.orientation} * spec.pose_PT;
    EXPECT_LE(distance(mapping.update(tip, {}, 0).pose, expected), 1e-14);
  }
  DeviceMapping plain{scene::WorkspaceMapping{}};
  const Pose tip = r.pose();
  EXPECT_LE(distance(plain.update(tip, {}, 0).pose, tip), 1e-15) << "the default maps D onto W";
}

TEST(DeviceMapping, TwistIsThePosesDerivativeAlsoAfterAClutch) {
  Random r;
  for (int n = 0; n < 50; ++n) {
    DeviceMapping mapping(r.spec());
    if (n % 2)
      mapping.update(r.pose(), {}, 4), mapping.update(r.pose(), {}, 4),
          mapping.update(r.pose(), {}, 0);
    const Pose tip = r.pose();
    const Twist twist{r.vec(), r.vec()};
    const double dt = 1e-6;
    const ToolState now = mapping.update(tip, twist, 0),
                    later = mapping.update(moved(tip, twist, dt), twist, 0);
    EXPECT_LE(((later.pose.position - now.pose.position) / dt - now.twist.linear).norm(), 1e-4);
    const Eigen::AngleAxisd turn(later.pose.orientation * now.pose.orientation.conjugate());
    EXPECT_LE((turn.angle() / dt * turn.axis() - now.twist.angular).norm(), 1e-4);
  }
}

/// For every motion: power at the hand = force_scale / position_scale times power in W.
TEST(DeviceMapping, PowerAtTheHandIsPowerInTheWorldTimesTheScales) {
  Random r;
  for (int n = 0; n < 200; ++n) {
    const scene::WorkspaceMapping spec = r.spec();
    DeviceMapping mapping(spec);
    if (n % 2)
      mapping.update(r.pose(), {}, 4), mapping.update(r.pose(), {}, 4);
    const Twist hand{r.vec(), r.vec()};
    const ToolState tool = mapping.update(r.pose(), hand, 0);
    const Wrench contact{r.vec(), r.vec()};
    const Wrench at_hand = wrench_to_device(spec, contact, tool.pose.orientation);
    const double in_world =
        contact.force.dot(tool.twist.linear) + contact.torque.dot(tool.twist.angular);
    const double in_hand = at_hand.force.dot(hand.linear) + at_hand.torque.dot(hand.angular);
    EXPECT_NEAR(in_hand, spec.force_scale / spec.position_scale * in_world,
                1e-12 * (1 + std::abs(in_world)) * 20);
  }
}

TEST(WrenchToDevice, InvalidOrientationKeepsTheCommandFinite) {
  scene::WorkspaceMapping device;
  device.pose_PT.position = Vec3(0.0, 0.0, 0.05);
  WrenchToDevice to_device(device);
  const Wrench wrench{Vec3(1.0, 2.0, 3.0), Vec3(0.1, 0.0, 0.0)};
  const Quat turned(Eigen::AngleAxisd(0.3, Vec3::UnitX()));
  const Wrench good = to_device(wrench, turned);
  EXPECT_EQ(good.torque, wrench_to_device(device, wrench, turned).torque) << "bit for bit";
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const Quat& bad :
       {Quat(kNan, 0, 0, 0), Quat(0, 0, 0, 0), Quat(1e200, 1e200, 0, 0), Quat(INFINITY, 0, 0, 0)}) {
    const Wrench kept = to_device(wrench, bad);
    EXPECT_TRUE(kept.finite());
    EXPECT_EQ(kept.torque, good.torque) << "as it was turned last";
  }
}

TEST(DeviceMapping, ForceComesBackAlongTheHandTimesTheForceScale) {
  scene::WorkspaceMapping spec;
  spec.force_scale = 0.5, spec.position_scale = 4;
  spec.pose_WD.orientation = Quat(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ()));
  DeviceMapping mapping(spec);
  mapping.update({}, {}, 0);
  const Wrench hand =
      wrench_to_device(spec, {{0, 2, 0}, {0, 8, 0}}, mapping.tool().pose.orientation);
  EXPECT_LE((hand.force - Vec3(1, 0, 0)).norm(), 1e-15) << "W's y is the hand's x";
  EXPECT_LE((hand.torque - Vec3(1, 0, 0)).norm(), 1e-15);
  spec.pose_PT.position = Vec3(0, 0, -0.1);  // the tool hangs below the tip
  DeviceMapping lever(spec);
  lever.update({}, {}, 0);
  EXPECT_LE((wrench_to_device(spec, {{0, 2, 0}, {0, 0, 0}}, lever.tool().pose.orientation).torque -
             Vec3(0, -0.025, 0))
                .norm(),
            1e-15)
      << "0.1 m of W is 0.025 m in the hand: 1 N there";
}

TEST(DeviceMapping, ClutchHoldsTheToolAndGoesOnWithoutAJump) {
  Random r;
  for (int n = 0; n < 50; ++n) {
    const scene::WorkspaceMapping spec = r.spec();
    DeviceMapping mapping(spec);
    Pose tip = r.pose();
    ToolState before = mapping.update(tip, {}, 0);
    for (int clutch = 0; clutch < 3; ++clutch) {
      for (int k = 0; k < 5; ++k) {
        const Twist twist{r.vec(), r.vec()};
        tip = moved(tip, twist, 0.3);
        const ToolState clutched = mapping.update(tip, twist, 4 | 1);
        EXPECT_TRUE(clutched.clutched);
        EXPECT_LE(distance(clutched.pose, before.pose), 1e-13);
        EXPECT_TRUE(clutched.twist.linear.isZero(0.0) && clutched.twist.angular.isZero(0.0));
      }
      const ToolState released = mapping.update(tip, {}, 1);
      EXPECT_FALSE(released.clutched);
      EXPECT_LE(distance(released.pose, before.pose), 1e-13);
      // From here on the tool follows the hand: the same rotation about the same axis of W.
      const Pose start = tip;
      tip = moved(tip, {r.vec(), r.vec()}, 0.2);
      before = mapping.update(tip, {}, 0);
      const Quat base = spec.pose_WD.orientation;
      const Quat hand_turn =
          base * tip.orientation * start.orientation.conjugate() * base.conjugate();
      const Quat tool_turn = before.pose.orientation * released.pose.orientation.conjugate();
      EXPECT_LE((hand_turn.toRotationMatrix() - tool_turn.toRotationMatrix()).norm(), 1e-13);
    }
  }
}

TEST(DeviceMapping, PressedClutchStartsAtTheHand) {
  Random r;
  const scene::WorkspaceMapping spec = r.spec();
  DeviceMapping pressed(spec), open(spec);
  const Pose tip = r.pose();
  EXPECT_LE(distance(pressed.update(tip, {}, 4).pose, open.update(tip, {}, 0).pose), 1e-14);
}

TEST(DeviceMapping, WithoutAButtonInTheSceneNoButtonClutches) {
  scene::WorkspaceMapping spec;
  DeviceMapping mapping(spec);
  EXPECT_FALSE(mapping.update({}, {}, 0xFFFFFFFFU).clutched);
}

TEST(DeviceMapping, RefusesInvalidPosesAndKeepsTheLast) {
  Random r;
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               inf = std::numeric_limits<double>::infinity();
  DeviceMapping mapping(r.spec());
  const Pose good = r.pose();
  const ToolState before = mapping.update(good, {r.vec(), r.vec()}, 0);
  std::vector<Pose> bad(6, good);
  bad[0].position.x() = nan;
  bad[1].position.z() = inf;
  bad[2].orientation.w() = nan;
  bad[3].orientation.coeffs().setZero();
  bad[4].orientation.coeffs() *= 1.01;
  bad[5].orientation.coeffs() *= 1e-160;
  for (const Pose& pose : bad) {
    const ToolState now = mapping.update(pose, {r.vec(), r.vec()}, 4);
    EXPECT_TRUE(now.refused);
    EXPECT_FALSE(now.clutched) << "nothing of a refused sample is used";
    EXPECT_EQ(now.pose.position, before.pose.position);
    EXPECT_TRUE(now.twist.linear.isZero(0.0));
  }
  Pose near = good;
  near.orientation.coeffs() *= 1.0009;
  const ToolState now = mapping.update(near, {{nan, 0, 0}, {0, 0, 0}}, 0);
  EXPECT_FALSE(now.refused);
  EXPECT_LE(distance(now.pose, before.pose), 1e-14) << "normalised";
  EXPECT_TRUE(now.twist.linear.isZero(0.0)) << "a twist that is not finite reads as zero";
  mapping.reset();
  EXPECT_FALSE(mapping.tool().refused);
}

TEST(DeviceMapping, PlaceAndVelocityStayFinite) {
  scene::WorkspaceMapping spec;
  spec.position_scale = 10.0;
  spec.pose_PT.position = Vec3(0.0, 0.0, 1.0);
  DeviceMapping mapping(spec);
  const Pose good{Vec3(0.1, 0.2, 0.3), Quat::Identity()};
  const Pose before = mapping.update(good, {}, 0).pose;
  for (const double far : {1e308, -1e308, 1e200, 1e13}) {
    const ToolState now = mapping.update({Vec3(0.0, far, 0.0), Quat::Identity()}, {}, 0);
    EXPECT_TRUE(now.refused) << far;
    EXPECT_EQ(now.pose.position, before.position);
  }
  EXPECT_FALSE(mapping.update({Vec3(0.0, 1e6, 0.0), Quat::Identity()}, {}, 0).refused);
  const ToolState fast = mapping.update(good, {Vec3(1e308, 0.0, 0.0), Vec3(0.0, 1e308, 1e308)}, 0);
  EXPECT_FALSE(fast.refused);
  EXPECT_TRUE(fast.twist.linear.isZero(0.0) && fast.twist.angular.isZero(0.0));
}

}  // namespace
}  // namespace voxtouch::rendering
