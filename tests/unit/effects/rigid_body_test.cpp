// The dynamic object as a body: how it falls, rests and is carried.
#include "core/effects/rigid_body.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace voxtouch::effects {
namespace {

constexpr double kStep = 1e-3;

BodyShape box_shape() {
  // 40 x 40 x 30 mm, solid, origin in the middle
  const auto axis = [](double a, double b) { return (a * a + b * b) / 12.0; };
  BodyShape shape;
  shape.inertia_m2 = Vec3(axis(0.04, 0.03), axis(0.04, 0.03), axis(0.04, 0.04)).asDiagonal();
  shape.reach_m = 0.032;
  return shape;
}
BodyParameters usual() {
  return {.mass_kg = 0.1,
          .gravity_m_per_s2 = {0, 0, -9.81},
          .grip_n_per_m = 200,
          .grip_nm_per_rad = 0.3,
          .grip_damping_ratio = 1};
}

/// A floor at z = 0 with stiffness k, at the body's origin.
BodyLoad floor_at(const Pose& pose, double k, double speed = 0.0) {
  BodyLoad load;
  if (pose.position.z() >= 0.0)
    return load;
  load.wrench.force.z() = -k * pose.position.z();
  load.stiffness(2, 2) = k;
  load.stiffness_bound_n_per_m = k;
  load.stiffness_times_velocity[2] = k * speed;
  return load;
}

TEST(RigidBody, FallsByGravityWhileReleased) {
  RigidBody body(box_shape());
  body.place({Vec3(0, 0, 1), Quat::Identity()}, false);
  for (int n = 0; n < 300; ++n)
    body.step({}, {}, {}, false, 0.0, usual(), kStep);
  EXPECT_NEAR(body.twist().linear.z(), -9.81 * 0.3, 1e-9);
  EXPECT_NEAR(body.pose().position.z(), 1 - 0.5 * 9.81 * 0.09, 2e-3)
      << "half a step early, as semi-implicit Euler is";
}

TEST(RigidBody, RestsOnAFloorOfAnyStiffness) {
  for (const double k : {100.0, 2e3, 1e5, 1e8}) {
    RigidBody body(box_shape());
    body.place({Vec3(0, 0, 0.02), Quat::Identity()}, false);
    double highest_after = -1.0;
    for (int n = 0; n < 4000; ++n) {
      body.step(floor_at(body.pose(), k), {}, {}, false, 0.0, usual(), kStep);
      if (n > 2000)
        highest_after = std::max(highest_after, body.pose().position.z());
    }
    EXPECT_NEAR(body.pose().position.z(), -0.1 * 9.81 / k, 1e-3 * 0.1 * 9.81 / k + 1e-6) << k;
    EXPECT_LT(std::abs(body.twist().linear.z()), 1e-4) << k;
    EXPECT_LT(highest_after, 1e-5) << "it does not bounce on and on";
  }
}

TEST(RigidBody, DisplaysItsWeightWhenHeldByTheTool) {
  RigidBody body(box_shape());
  const Pose tool{Vec3(0.1, 0.2, 0.3), Quat(Eigen::AngleAxisd(0.4, Vec3::UnitY()))};
  body.place(tool, true);
  BodyGrip grip;
  for (int n = 0; n < 3000; ++n)
    grip = body.step({}, tool, {}, true, 0.0, usual(), kStep);
  EXPECT_LT((grip.wrench.force - Vec3(0, 0, -0.981)).norm(), 1e-6);
  EXPECT_NEAR((body.pose().position - tool.position).z(), -0.981 / 200, 1e-7);
  EXPECT_LT(grip.wrench.torque.norm(), 1e-6) << "its centre of mass is where it is held";
}

TEST(RigidBody, GrippedOffCentreGivesATorque) {
  BodyShape shape = box_shape();
  shape.centre = Vec3(0.02, 0, 0);
  RigidBody body(shape);
  body.place({}, true);
  BodyParameters p = usual();
  p.grip_nm_per_rad = 50;  // so that it hardly rotates
  BodyGrip grip;
  for (int n = 0; n < 3000; ++n)
    grip = body.step({}, {}, {}, true, 0.0, p, kStep);
  EXPECT_NEAR(grip.wrench.torque.y(), 0.981 * 0.02, 1e-4);
}

TEST(RigidBody, IsGrippedWithoutAnInitialForce) {
  RigidBody body(box_shape());
  BodyParameters p = usual();
  p.gravity_m_per_s2.setZero();
  body.place({Vec3(0, 0, 0), Quat::Identity()}, false);
  const Pose tool{Vec3(0.012, 0.005, 0), Quat(Eigen::AngleAxisd(0.5, Vec3::UnitX()))};
  EXPECT_FALSE(body.step({}, tool, {}, true, 0.01, p, kStep).wrench.force.norm() > 0.0)
      << "too far to be taken up";
  EXPECT_FALSE(body.held());
  double most = 0.0;
  for (int n = 0; n < 500; ++n)
    most = std::max(most, body.step({}, tool, {}, true, 0.02, p, kStep).wrench.force.norm());
  EXPECT_TRUE(body.held());
  EXPECT_LT(most, 1e-9);
  EXPECT_LT(body.pose().position.norm(), 1e-9) << "it stays where it lay";
}

TEST(RigidBody, ReleaseRampsTheWeightDown) {
  RigidBody body(box_shape());
  const Pose tool{Vec3(0, 0, 1), Quat::Identity()};
  body.place(tool, true);
  double last = 0.0, largest = 0.0;
  for (int n = 0; n < 2000; ++n)
    last = body.step({}, tool, {}, true, 0.0, usual(), kStep).wrench.force.z();
  for (int n = 0; n < 200; ++n) {
    const double now = body.step({}, tool, {}, false, 0.0, usual(), kStep).wrench.force.z();
    largest = std::max(largest, std::abs(now - last));
    last = now;
  }
  EXPECT_EQ(last, 0.0);
  EXPECT_LT(largest, 0.08 * 0.981)
      << "a fiftieth a sample, and the grip's damper as the body begins to fall";
}

/// The hand gets at most the energy of the store: kinetic, height, grip and the floor's spring.
TEST(RigidBody, GivesOnlyItsStoredEnergy) {
  std::mt19937_64 random(5);
  const auto uniform = [&](double a, double b) {
    return a + (b - a) * 0x1p-53 * static_cast<double>(random() >> 11);
  };
  for (int run = 0; run < 100; ++run) {
    RigidBody body(box_shape());
    BodyParameters p = usual();
    p.mass_kg = std::pow(10.0, uniform(-2, 0.5)), p.grip_n_per_m = std::pow(10.0, uniform(1, 3));
    p.grip_nm_per_rad = std::pow(10.0, uniform(-2, 0)), p.grip_damping_ratio = uniform(0.3, 1.5);
    const double fx = uniform(0.3, 3), fz = uniform(0.3, 3), size = uniform(0.005, 0.05),
                 k = std::pow(10.0, uniform(2, 3));
    const auto at = [&](double t) {
      const double grown =
          t < 1.0 ? t * t * (3.0 - 2.0 * t) : 1.0;  // no hand is at full speed at once
      const Vec3 x(grown * size * std::sin(fx * t), 0.0, grown * size * std::sin(fz * t));
      return Pose{
          x, Quat(Eigen::AngleAxisd(grown * 0.5 * std::sin(fx * t), Vec3(1, 2, 0).normalized()))};
    };
    body.place(at(0), true);
    double given = 0.0, moved = 0.0;
    BodyGrip grip = body.step(floor_at(body.pose(), k), at(0), {}, true, 0.0, p, kStep);
    const auto store = [&] {
      return body.energy_j() + 0.5 * k * std::pow(std::min(0.0, body.pose().position.z()), 2);
    };
    const double begin = store();
    for (int n = 1; n < 8000; ++n) {
      const Pose from = at((n - 1) * kStep), to = at(n * kStep);
      const Eigen::AngleAxisd turn(to.orientation * from.orientation.conjugate());
      const double work = grip.wrench.force.dot(to.position - from.position) +
                          grip.wrench.torque.dot(turn.angle() * turn.axis());
      given += work, moved += std::abs(work);
      const Twist twist{(to.position - from.position) / kStep, turn.angle() * turn.axis() / kStep};
      grip = body.step(floor_at(body.pose(), k), to, twist, true, 0.0, p, kStep);
      // A force that is constant over a period lags by half of it: at the start all motion had one
      // direction.
      ASSERT_LE(given, begin - store() + 0.02 * moved + 5e-6) << "run " << run << ", step " << n;
    }
    EXPECT_LE(given, begin - store() + 0.02 * moved) << "run " << run;
  }
}

TEST(RigidBody, RidesOnAFloorThatMoves) {
  RigidBody body(box_shape());
  body.place({}, false);
  const double speed = 0.05;
  for (int n = 0; n < 2000; ++n) {
    Pose relative = body.pose();
    relative.position.z() -= speed * n * kStep;
    body.step(floor_at(relative, 2e3, speed), {}, {}, false, 0.0, usual(), kStep);
  }
  EXPECT_NEAR(body.twist().linear.z(), speed, 1e-6);
  EXPECT_NEAR(body.pose().position.z() - speed * 2000 * kStep, -0.981 / 2e3, 2e-6)
      << "no deeper than on one that rests";
}

TEST(RigidBody, StopsForANonFiniteLoad) {
  RigidBody body(box_shape());
  body.place({}, false);
  BodyLoad load;
  load.wrench.force.x() = std::nan("");
  const BodyGrip grip = body.step(load, {}, {}, false, 0.0, usual(), kStep);
  EXPECT_TRUE(body.pose().finite());
  EXPECT_TRUE(grip.wrench.zero());
  body.step({}, {}, {}, false, 0.0, usual(), kStep);
  EXPECT_TRUE(body.twist().finite());
}

TEST(RigidBody, KeepsTheSpinOfAFreeTop) {
  BodyShape shape = box_shape();
  RigidBody body(shape);
  BodyParameters p = usual();
  p.gravity_m_per_s2.setZero();
  body.place({}, false);
  BodyLoad kick;
  kick.wrench.torque = Vec3(0.02, 0.01, 0.03);
  for (int n = 0; n < 10; ++n)
    body.step(kick, {}, {}, false, 0.0, p, kStep);
  const double begin = body.energy_j();
  for (int n = 0; n < 5000; ++n)
    body.step({}, {}, {}, false, 0.0, p, kStep);
  EXPECT_NEAR(body.energy_j() / begin, 1.0, 0.1) << "explicit gyroscopic torque drifts a little";
}

}  // namespace
}  // namespace voxtouch::effects
