#include "devices/lwr/simulated/lwr_plant.hpp"
#include "tests/unit/lwr_sim/arm_energy.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

namespace voxtouch::lwr_sim {
namespace {

constexpr double kDt = 0.25e-3;

lwr::LwrJoints joints(double a, double b, double c, double d, double e, double f, double g) {
  lwr::LwrJoints q;
  q << a, b, c, d, e, f, g;
  return q;
}
const lwr::LwrJoints kBent = joints(0.1, 0.5, -0.2, -1.5, 0.3, 1.0, 0.2);

PlantParameters bare() {
  PlantParameters p;
  p.bodies = lwr_bodies();
  return p;
}

/// A hand with a constant force and an attached mass.
hand::HandAction push(const Vec3& force, const TipLoad& load = {}) {
  hand::HandAction hand;
  hand.steady_force = force;
  hand.mass_kg = load.mass_kg;
  hand.inertia_kg_m2 = load.inertia_kg_m2;
  return hand;
}

double largest_drift(ArmPlant& plant, const TipLoad& load, double seconds, double dt_s) {
  const double start = kinetic_energy(plant.dynamics(), plant.q(), plant.rate(), load);
  double worst = 0.0;
  const int steps = static_cast<int>(std::lround(seconds / dt_s));
  for (int i = 0; i < steps; ++i) {
    plant.step(lwr::LwrJoints::Zero(), Drives::kTorque, push(Vec3::Zero(), load), dt_s);
    if (i % 40 == 0)
      worst = std::max(
          std::abs(kinetic_energy(plant.dynamics(), plant.q(), plant.rate(), load) / start - 1.0),
          worst);
  }
  return worst;
}

TEST(ArmPlant, AnArmWithoutDampingKeepsItsEnergy) {
  ArmPlant plant(bare(), kBent);
  plant.set_state(kBent, joints(0.8, -0.6, 1.0, 0.9, -1.2, 0.7, 1.5));
  const auto start = std::chrono::steady_clock::now();
  const double drift = largest_drift(plant, {}, 10.0, kDt);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  RecordProperty("relative_drift", std::to_string(drift));
  std::printf("10 s of free motion: relative drift %.2g, took %.2f s\n", drift, elapsed.count());
  EXPECT_LE(drift, 1e-6);
  EXPECT_GT((plant.q() - kBent).cwiseAbs().maxCoeff(), 1.0) << "the arm did not move";
}

TEST(ArmPlant, AnArmWithAHandsMassKeepsItsEnergy) {
  ArmPlant plant(bare(), kBent);
  plant.set_state(kBent, joints(0.8, -0.6, 1.0, 0.9, -1.2, 0.7, 1.5));
  EXPECT_LE(largest_drift(plant, {1.3, 0.01}, 2.0, kDt), 1e-6);
}

TEST(ArmPlant, AHandsPushDoesTheWorkThatTheArmGains) {
  PlantParameters p = bare();
  const hand::HandAction hand = push(Vec3(3.0, -5.0, 2.0), {1.0, 0.0});
  ArmPlant plant(p, kBent);
  const Vec3 start = plant.terms().tool.position;
  for (int i = 0; i < 2000; ++i)
    plant.step(lwr::LwrJoints::Zero(), Drives::kTorque, hand, kDt);
  const double work = hand.steady_force.dot(plant.terms().tool.position - start);
  EXPECT_GT(work, 0.01);
  EXPECT_NEAR(kinetic_energy(plant.dynamics(), plant.q(), plant.rate(), {1.0, 0.0}), work,
              1e-6 * work);
}

TEST(ArmPlant, StaysExactlyInPlaceBelowItsFriction) {
  ArmPlant plant(lwr_plant(), kBent);
  const hand::HandAction hand = push(Vec3(0.05, 0.05, 0.05));
  for (int i = 0; i < 4000; ++i)
    plant.step(lwr::LwrJoints::Zero(), Drives::kTorque, hand, kDt);
  EXPECT_EQ(plant.q(), kBent);
  EXPECT_EQ(plant.rate(), lwr::LwrJoints::Zero());
}

TEST(ArmPlant, JointHeldByFrictionDoesNotChatter) {
  PlantParameters p = lwr_plant();
  p.coulomb_nm[2] = 50.0;  // held, whatever the others do
  ArmPlant plant(p, kBent);
  const hand::HandAction hand = push(Vec3(10.0, 10.0, 0.0));
  for (int i = 0; i < 800; ++i)
    plant.step(lwr::LwrJoints::Zero(), Drives::kTorque, hand, kDt);
  EXPECT_EQ(plant.rate()[2], 0.0);
  EXPECT_EQ(plant.q()[2], kBent[2]);
  EXPECT_GT(plant.rate().norm(), 0.1);
}

TEST(ArmPlant, FrictionOnlyTakesEnergy) {
  ArmPlant plant(lwr_plant(), kBent);
  plant.set_state(kBent, joints(0.4, -0.3, 0.5, 0.4, -0.6, 0.3, 0.7));
  double before = kinetic_energy(plant.dynamics(), plant.q(), plant.rate());
  for (int i = 0; i < 60000; ++i) {
    plant.step(lwr::LwrJoints::Zero(), Drives::kTorque, {}, kDt);
    const double now = kinetic_energy(plant.dynamics(), plant.q(), plant.rate());
    ASSERT_LE(now, before * (1.0 + 1e-12)) << "step " << i;
    before = now;
  }
  EXPECT_EQ(before, 0.0);
}

TEST(ArmPlant, BrakesHoldTheArmAgainstGravityAndAPush) {
  ArmPlant plant(lwr_plant(), kBent);
  plant.set_state(kBent, joints(0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5));
  const hand::HandAction hand = push(Vec3(60.0, 0.0, -60.0));
  int moving = 0;
  for (int i = 0; i < 4000; ++i) {
    plant.step(lwr::LwrJoints::Zero(), Drives::kBraked, hand, kDt);
    moving += plant.rate().isZero(0.0) ? 0 : 1;
  }
  EXPECT_LT(moving * kDt, 0.05);
  EXPECT_EQ(plant.rate(), lwr::LwrJoints::Zero());
  EXPECT_LT((plant.q() - kBent).norm(), 0.02);
}

TEST(ArmPlant, StopsAtItsJointLimitsAndComesOffThem) {
  const double limit = lwr::lwr_limits().position_rad[3];
  lwr::LwrJoints q = kBent;
  q[3] = -limit + 0.01;
  ArmPlant plant(lwr_plant(), q);
  plant.set_state(q, joints(0, 0, 0, -1.0, 0, 0, 0));
  bool stopped = false;
  for (int i = 0; i < 400; ++i) {
    plant.step(lwr::LwrJoints::Zero(), Drives::kTorque, {}, kDt);
    ASSERT_GE(plant.q()[3], -limit);
    stopped = stopped || plant.at_stop();
  }
  EXPECT_TRUE(stopped);
  const lwr::LwrJoints back = joints(0, 0, 0, 5.0, 0, 0, 0);
  for (int i = 0; i < 400; ++i)
    plant.step(back, Drives::kTorque, {}, kDt);
  EXPECT_GT(plant.q()[3], -limit + 1e-3);
}

TEST(ArmPlant, DrivesGiveNoMoreThanTheyCan) {
  ArmPlant plant(lwr_plant(), kBent);
  plant.step(lwr::LwrJoints::Constant(1e6), Drives::kTorque, {}, kDt);
  EXPECT_LE(
      (plant.sensed_torque() - lwr_plant().coulomb_nm - lwr::lwr_limits().torque_nm).maxCoeff(),
      1e-9);
}

TEST(ArmPlant, GravityIsCarriedUpToTheDrivesLimit) {
  ArmPlant plant(lwr_plant(), joints(0, 1.5, 0, 0.1, 0, 0, 0));
  for (int i = 0; i < 4000; ++i)
    plant.step(lwr::LwrJoints::Zero(), Drives::kTorque, {}, kDt);
  EXPECT_EQ(plant.q(), joints(0, 1.5, 0, 0.1, 0, 0, 0));
  EXPECT_NEAR((plant.sensed_torque() - plant.terms().gravity).norm(), 0.0, 1e-9);
}

}  // namespace
}  // namespace voxtouch::lwr_sim
