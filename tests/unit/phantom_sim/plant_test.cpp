// The arm in a hand, step by step: energy, friction, stops, limits of the motors, sensors.
#include "devices/phantom/simulated/plant.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "devices/phantom/simulated/sensors.hpp"
#include "tests/unit/phantom_sim/apparent_mass.hpp"

namespace voxtouch::hd_sim {
namespace {

Motion still(const Vec3& at = Vec3::Zero()) {
  return {.path = {at}, .repeat_from = {}, .circle_centre = {}};
}

sim::OperatorConfig released() {
  sim::OperatorConfig hand;
  hand.released = true;
  return hand;
}

PlantConfig frictionless() {
  PlantConfig config;
  config.viscous_nms_per_rad = 0.0;
  config.coulomb_nm = 0.0;
  return config;
}

PhantomPlant plant_of(const PlantConfig& config, const sim::OperatorConfig& hand = released(),
                      const Motion& motion = still()) {
  return PhantomPlant(config, hand, motion, 0, hand::Hand::kBandwidthHz);
}

Vec3 torque_of(const PhantomPlant& plant, const Vec3& force) {
  return phantom::phantom_jacobian(plant.config().geometry, plant.joints()).transpose() * force;
}

/// Largest change of the energy over 10 s, relative to the energy of motion at the start.
double drift(double gravity) {
  PlantConfig config = frictionless();
  config.gravity_m_per_s2 = gravity;
  config.stop_nm_per_rad = config.stop_nms_per_rad = 0.0;  // the arm may go round
  PhantomPlant plant = plant_of(config);
  const Vec3 rates(2.0, -1.5, 3.0);
  plant.set_state({0.3, 0.2, -0.1}, rates);
  const double start = plant.energy(),
               motion = 0.5 * rates.dot(plant.dynamics().mass(plant.joints()) * rates);
  double worst = 0.0;
  for (int i = 0; i < 80000; ++i) {
    plant.step(Vec3::Zero());
    worst = std::max(worst, std::abs(plant.energy() - start) / motion);
  }
  EXPECT_GT((plant.joints() - Vec3(0.3, 0.2, -0.1)).norm(), 0.5);
  return worst;
}

TEST(Plant, FreeArmKeepsItsEnergyForTenSeconds) {
  const double without = drift(0.0), with = drift(9.81);
  RecordProperty("drift_without_gravity", std::to_string(without * 1e12) + "e-12");
  RecordProperty("drift_with_gravity", std::to_string(with * 1e12) + "e-12");
  EXPECT_LT(without, 1e-8);
  EXPECT_LT(with, 1e-8);
}

TEST(Plant, AcceleratesByItsApparentMassAndTheHands) {
  for (const double hand_kg : {0.0, 0.1}) {
    PlantConfig config = frictionless();
    config.gravity_m_per_s2 = 0.0;
    sim::OperatorConfig hand;
    hand.mass_kg = hand_kg;
    PhantomPlant plant = plant_of(config, hand);
    const Vec3 mass = apparent_mass(plant.dynamics(), plant.joints()) + Vec3::Constant(hand_kg);
    plant.step(torque_of(plant, {1.0, 1.0, 1.0}));
    // At rest the axes hardly couple.
    EXPECT_LT((plant.tip_velocity() / kSubstep - mass.cwiseInverse()).norm(),
              1e-3 * mass.cwiseInverse().norm());
  }
}

TEST(Plant, UndampedHandKeepsItsEnergyToo) {
  PlantConfig config = frictionless();
  config.gravity_m_per_s2 = 0.0;
  sim::OperatorConfig hand;
  hand.mass_kg = 0.1;
  hand.stiffness_n_per_m = 300.0;
  PhantomPlant plant = plant_of(config, hand);
  plant.set_state({0.1, 0.1, -0.1}, Vec3::Zero());
  const auto energy = [&] {
    return plant.energy() + 0.5 * 0.1 * plant.tip_velocity().squaredNorm() +
           150.0 * plant.tip().squaredNorm();
  };
  const double start = energy();
  for (int i = 0; i < 80000; ++i)
    plant.step(Vec3::Zero());
  EXPECT_NEAR(energy() / start, 1.0, 1e-6);
}

TEST(Plant, JointAtRestIsNotMovedByLessThanItsFriction) {
  PlantConfig config;
  config.gravity_m_per_s2 = 0.0;
  PhantomPlant plant = plant_of(config);
  plant.set_state({0.2, 0.1, -0.2}, Vec3::Zero());
  for (int i = 0; i < 8000; ++i)
    plant.step({0.0099, -0.0099, 0.0099});
  EXPECT_EQ(plant.joints(), Vec3(0.2, 0.1, -0.2));
  EXPECT_EQ(plant.rates(), Vec3(Vec3::Zero()));
  for (int i = 0; i < 800; ++i)
    plant.step({0.0099, 0.012, 0.0099});
  EXPECT_EQ(plant.joints()[0], 0.2);  // the turret is independent of the thigh
  EXPECT_GT(plant.joints()[1], 0.1 + 1e-3);

  // At zero even the smallest double would be seen; a hand pulls and the weight as well.
  sim::OperatorConfig hand = *hand::grip("pen");
  hand.carries_tool = false;
  config = {};
  config.coulomb_nm = 0.1;
  plant = plant_of(config, hand, still());
  plant.follow(still({1e-3, 1e-3, -1e-3}));
  for (int i = 0; i < 8000; ++i)
    plant.step({0.003, -0.002, 0.001});
  EXPECT_EQ(plant.joints(), *phantom::phantom_joints({}, Vec3::Zero()));
}

TEST(Plant, FrictionOnlyTakesEnergyAndThenHolds) {
  PlantConfig config;
  config.gravity_m_per_s2 = 0.0;
  PhantomPlant plant = plant_of(config);
  plant.set_state({0.0, 0.1, 0.1}, {2.0, -1.0, 1.5});
  double before = plant.energy();
  int moving = 0;
  for (int i = 0; i < 16000; ++i) {
    plant.step(Vec3::Zero());
    const double now = plant.energy();
    EXPECT_LE(now, before * (1.0 + 1e-12));
    before = now;
    if (!plant.rates().isZero(0.0))
      ++moving;
  }
  EXPECT_EQ(plant.rates(), Vec3(Vec3::Zero()));
  EXPECT_GT(moving, 800);
  EXPECT_LT(moving, 12000);
}

TEST(Plant, SlidesAgainstItsFriction) {
  PlantConfig config;
  config.gravity_m_per_s2 = 0.0;
  config.viscous_nms_per_rad = 0.0;
  PhantomPlant plant = plant_of(config);
  const double inertia = plant.dynamics().mass(Vec3::Zero())(0, 0);
  for (int i = 0; i < 80; ++i)
    plant.step({0.03, 0.0, 0.0});
  EXPECT_NEAR(plant.rates()[0], 0.02 / inertia * 0.01, 1e-6);  // 0.01 of the 0.03 Nm are lost
}

TEST(Plant, MotorsGiveNoMoreThanTheyCan) {
  PhantomPlant plant = plant_of({});
  plant.step({10.0, -10.0, 0.5});
  EXPECT_EQ(plant.motor_torque(), Vec3(1.8275, -1.8275, 0.5));
  plant = plant_of({});
  plant.step(torque_of(plant, {8.5, 0.0, 0.0}));
  EXPECT_NEAR(plant.motor_force().x(), 8.5, 1e-3);
}

TEST(Plant, StopsHoldAgainstTheMotors) {
  for (const Vec3& push : {Vec3(8.5, 0.0, 0.0), Vec3(-8.5, 0.0, 0.0), Vec3(0.0, 8.5, 0.0),
                           Vec3(0.0, -8.5, 0.0), Vec3(0.0, 0.0, 8.5), Vec3(0.0, 0.0, -8.5)}) {
    const PlantConfig config;
    PhantomPlant plant = plant_of(config);
    for (int i = 0; i < 16000; ++i) {
      plant.step(torque_of(plant, push));
      ASSERT_LT(std::abs(plant.joints()[0]), config.turret_stop_rad + 0.2);
      ASSERT_LT(plant.joints()[1] - plant.joints()[2], config.fold_rad + 0.2);
      ASSERT_GT(plant.joints()[1] - plant.joints()[2], -config.stretch_rad - 0.2);
      ASSERT_LT(plant.joints()[1], config.thigh_high_rad + 0.2);
      ASSERT_GT(plant.joints()[1], config.thigh_low_rad - 0.2);
    }
  }
}

TEST(Plant, HandLeadsTheTipToItsTarget) {
  Motion motion = still();
  motion.path.push_back({0.05, 0.04, -0.03});
  motion.speed_m_per_s = 0.1;
  PhantomPlant plant = plant_of({}, *hand::grip("pen"), motion);
  for (int i = 0; i < 24000; ++i)
    plant.step(Vec3::Zero());
  EXPECT_LT((plant.tip() - motion.path.back()).norm(), 1.5e-3);  // friction and weight over 300 N/m
  EXPECT_GT((plant.tip() - motion.path.back()).norm(), 1e-6);
}

TEST(Plant, ReleasedArmIsMovedByItsWeightAlone) {
  PhantomPlant plant = plant_of({});
  for (int i = 0; i < 2400; ++i)
    plant.step(Vec3::Zero());
  EXPECT_GT(plant.tip().norm(), 1e-3);
  EXPECT_EQ(plant.hand_force(), Vec3(Vec3::Zero()));
}

TEST(Plant, RefusesWhatItCannotSimulate) {
  EXPECT_THROW(plant_of({}, released(), still({0.0, 0.0, 0.5})), std::runtime_error);
  sim::OperatorConfig vice;
  vice.stiffness_n_per_m = 1e7;
  EXPECT_THROW(plant_of({}, vice), std::runtime_error);
  vice.stiffness_n_per_m = 1e5;
  vice.grip_factor = 100.0;
  EXPECT_THROW(plant_of({}, vice), std::runtime_error);
}

TEST(Plant, SameCallsAreBitIdentical) {
  sim::OperatorConfig hand = *hand::grip("pen");
  hand.tremor_n = 0.2;
  PhantomPlant a(PlantConfig{}, hand, still(), 5, hand::Hand::kBandwidthHz),
      b(PlantConfig{}, hand, still(), 5, hand::Hand::kBandwidthHz);
  for (int i = 0; i < 8000; ++i) {
    const Vec3 torque(0.1 * std::sin(0.01 * i), 0.05, -0.02);
    a.step(torque);
    b.step(torque);
    ASSERT_EQ(a.joints(), b.joints());
    ASSERT_EQ(a.rates(), b.rates());
  }
}

TEST(Sensors, StepAtTheTipIsThatOfTheEncoder) {
  Sensors sensors({}, 0.03e-3, 1e-3, 50.0);
  const phantom::PhantomGeometry geometry;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 one = sensors.step_rad()[axis] * Vec3::Unit(axis);
    EXPECT_NEAR(phantom::phantom_tip(geometry, one).norm(), 0.03e-3, 1e-8);
  }
  const Vec3 joints(0.12345, -0.2345, 0.3456);
  const Reading& r = sensors.sample(joints, Quat::Identity());
  EXPECT_LT((r.joints - joints).cwiseAbs().cwiseQuotient(sensors.step_rad()).maxCoeff(),
            0.5 + 1e-9);
  EXPECT_LT((r.pose.position - phantom::phantom_tip(geometry, joints)).norm(), 0.03e-3);
  EXPECT_LT(r.pose.orientation.angularDistance(Quat::Identity()), 2e-3);
}

TEST(Sensors, AnglesAreRelativeToTheirZero) {
  Sensors sensors({}, 0.03e-3, 1e-3, 50.0);
  sensors.zero_at({0.1, 0.2, -0.1});
  EXPECT_EQ(sensors.sample({0.1, 0.2, -0.1}, Quat::Identity()).joints, Vec3(Vec3::Zero()));
}

TEST(Sensors, VelocityIsSmoothedAndArrives) {
  Sensors sensors({}, 0.03e-3, 1e-3, 50.0);
  sensors.set_period(1e-3);
  for (int i = 0; i <= 300; ++i)
    sensors.sample({0.001 * i, 0.0, 0.0}, Quat::Identity());
  EXPECT_NEAR(sensors.reading().twist.linear.norm(), 0.215, 0.02);  // 1 rad/s at the thigh's length
}

}  // namespace
}  // namespace voxtouch::hd_sim
