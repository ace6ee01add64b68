// The operator's hand alone: its force, its release, and its bandwidth.
#include "devices/operator/hand.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "devices/sim/parameters.hpp"
#include "devices/sim/plant.hpp"

namespace voxtouch::hd_sim {
namespace hand_test {

constexpr double kStep = 1.0 / 8000.0;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Motion still(const Vec3& at) { return {.path = {at}, .repeat_from = {}, .circle_centre = {}}; }

sim::OperatorConfig plain(double mass, double damping, double stiffness) {
  sim::OperatorConfig config;
  config.mass_kg = mass;
  config.damping_ns_per_m = damping;
  config.stiffness_n_per_m = stiffness;
  return config;
}

hand::HandAction run_until(hand::Hand& hand, double time_s) {
  hand::HandAction action;
  while (hand.time_s() < time_s)
    action = hand.step();
  return action;
}

TEST(Hand, PullsTowardsItsTargetAndBrakes) {
  hand::Hand hand(plain(0.1, 4.0, 300.0), still({0.01, 0.0, 0.0}), kStep);
  const hand::HandAction action = hand.step();
  EXPECT_NEAR(action.force(Vec3::Zero(), Vec3::Zero()).x(), 3.0, 1e-12);
  EXPECT_NEAR(action.force({0.01, 0.0, 0.0}, {0.0, 0.5, 0.0}).y(), -2.0, 1e-12);
  EXPECT_DOUBLE_EQ(action.mass_kg, 0.1);
}

TEST(Hand, ReleaseIsPermanent) {
  sim::OperatorConfig config = plain(0.1, 4.0, 300.0);
  config.release_time_s = 0.5;
  hand::Hand hand(config, still({0.01, 0.0, 0.0}), kStep);
  EXPECT_GT(run_until(hand, 0.5).stiffness_n_per_m, 0.0);
  for (int i = 0; i < 100; ++i) {
    const hand::HandAction open = hand.step();
    EXPECT_EQ(open.mass_kg, 0.0);
    EXPECT_EQ(open.force({0.1, 0.1, 0.1}, {1.0, 1.0, 1.0}), Vec3(Vec3::Zero()));
  }
  EXPECT_FALSE(hand.holds());
}

TEST(Hand, GripsHarderFromItsTimeOn) {
  sim::OperatorConfig config = plain(0.1, 4.0, 300.0);
  config.grip_change_time_s = 0.25;
  config.grip_factor = 3.0;
  hand::Hand hand(config, still(Vec3::Zero()), kStep);
  EXPECT_DOUBLE_EQ(run_until(hand, 0.25).stiffness_n_per_m, 300.0);
  const hand::HandAction firm = hand.step();
  EXPECT_DOUBLE_EQ(firm.stiffness_n_per_m, 900.0);
  EXPECT_DOUBLE_EQ(firm.damping_ns_per_m, 12.0);
  EXPECT_DOUBLE_EQ(firm.mass_kg, 0.1);
}

TEST(Hand, FirmerGripActsOnOtherSimulatedDevices) {
  sim::SimParameters p = sim::sim_phantom();
  p.description.coulomb_friction_n = 0.0;
  sim::OperatorConfig config = plain(0.1, 4.0, 300.0);
  config.grip_change_time_s = 1.0;
  config.grip_factor = 4.0;
  sim::SimPlant plant(p, config, still(Vec3::Zero()));
  plant.set_state({{0.01, 0.0, 0.0}, Quat::Identity()}, {});
  EXPECT_NEAR(plant.energy(1.5) / plant.energy(0.5), 4.0, 1e-12);
}

/// Amplitude of the target on a circle of frequency `hz`, divided by the circle's.
double response(double hz, double bandwidth_hz) {
  const double radius = 0.02;
  Motion circle = still({radius, 0.0, 0.0});
  circle.speed_m_per_s = 2.0 * std::numbers::pi * hz * radius;
  circle.circle_centre = Vec3::Zero();
  hand::Hand hand(plain(0.1, 4.0, 300.0), circle, kStep, 0, {}, bandwidth_hz);
  run_until(hand, 10.0 / hz + 1.0);
  return hand.target().norm() / radius;
}

TEST(Hand, FollowsAtHumanSpeedAtMost) {
  EXPECT_NEAR(response(5.0, hand::Hand::kBandwidthHz), std::numbers::sqrt2 / 2.0, 1e-3);
  EXPECT_GT(response(0.5, hand::Hand::kBandwidthHz), 0.99);
  EXPECT_LT(response(50.0, hand::Hand::kBandwidthHz), 0.03);
  EXPECT_NEAR(response(50.0, kInfinity), 1.0, 1e-9);
}

TEST(Hand, TargetVelocityIsTheDifferenceOfTargets) {
  Motion motion = still(Vec3::Zero());
  motion.path.push_back({0.03, -0.02, 0.01});
  motion.speed_m_per_s = 0.2;
  hand::Hand hand(plain(0.1, 4.0, 300.0), motion, kStep);
  for (int i = 0; i < 4000; ++i) {
    const Vec3 before = hand.target();
    const hand::HandAction action = hand.step();
    EXPECT_LT((action.target.velocity - (hand.target() - before) / kStep).norm(), 1e-12);
  }
  EXPECT_LT((hand.target() - motion.path.back()).norm(), 1e-4);
}

TEST(Hand, CarriesItsToolOnlyWhileItMoves) {
  sim::OperatorConfig config = plain(0.1, 0.0, 0.0);
  config.carries_tool = true;
  Motion motion = still(Vec3::Zero());
  motion.path.push_back({0.1, 0.0, 0.0});
  motion.hold_s = 0.5;
  hand::Hand hand(config, motion, kStep, 0, {0.02, 0.05});
  EXPECT_EQ(run_until(hand, 0.4).steady_force, Vec3(Vec3::Zero()));
  EXPECT_NEAR(run_until(hand, 2.0).steady_force.x(), 0.05, 2e-3);
}

TEST(Hand, SameSeedSameTremor) {
  sim::OperatorConfig config = plain(0.1, 4.0, 300.0);
  config.tremor_n = 0.1;
  hand::Hand a(config, still(Vec3::Zero()), kStep, 3), b(config, still(Vec3::Zero()), kStep, 3),
      c(config, still(Vec3::Zero()), kStep, 4);
  bool differs = false;
  double power = 0.0;
  for (int i = 0; i < 80000; ++i) {
    const Vec3 force = a.step().steady_force;
    ASSERT_EQ(force, b.step().steady_force);
    differs |= force != c.step().steady_force;
    power += force.squaredNorm() / 3.0 / 80000.0;
  }
  EXPECT_TRUE(differs);
  EXPECT_NEAR(std::sqrt(power), 0.1, 0.02);
}

TEST(Hand, BlendsIntoANewMotion) {
  hand::Hand hand(plain(0.1, 4.0, 300.0), still(Vec3::Zero()), kStep);
  run_until(hand, 0.1);
  hand.follow(still({0.05, 0.0, 0.0}));
  const hand::HandAction next = hand.step();
  EXPECT_LT(next.target.position.norm(), 1e-4);
  run_until(hand, 1.0);
  EXPECT_NEAR(hand.target().x(), 0.05, 1e-6);
}

TEST(Hand, TorqueRestoresItsOrientation) {
  sim::OperatorConfig config = plain(0.1, 4.0, 300.0);
  config.stiffness_nm_per_rad = 0.5;
  hand::Hand hand(config, still(Vec3::Zero()), kStep);
  const hand::HandAction action = hand.step();
  const Quat turned(Eigen::AngleAxisd(0.1, Vec3::UnitX()));
  EXPECT_NEAR(action.torque(turned, Vec3::Zero()).x(), -0.05, 1e-4);
  Quat other = turned;
  other.coeffs() *= -1.0;
  EXPECT_NEAR(action.torque(other, Vec3::Zero()).x(), -0.05, 1e-4);
}

TEST(Hand, EveryNamedGripIsValid) {
  ASSERT_FALSE(hand::grip_names().empty());
  for (const std::string_view name : hand::grip_names()) {
    const auto config = hand::grip(name);
    ASSERT_TRUE(config) << name;
    EXPECT_NO_THROW(config->validate()) << name;
    EXPECT_EQ(config->released, name == "released");
  }
  EXPECT_FALSE(hand::grip("tentacle"));
}

TEST(Hand, RefusesInvalidMotions) {
  const sim::OperatorConfig config = plain(0.1, 4.0, 300.0);
  Motion motion = still(Vec3::Zero());
  motion.path.clear();
  EXPECT_THROW(hand::Hand(config, motion, kStep), std::runtime_error);
  motion = still({std::nan(""), 0.0, 0.0});
  EXPECT_THROW(hand::Hand(config, motion, kStep), std::runtime_error);
  motion = still(Vec3::Zero());
  motion.repeat_from = 3;
  EXPECT_THROW(hand::Hand(config, motion, kStep), std::runtime_error);
  motion = still(Vec3::Zero());
  EXPECT_THROW(hand::Hand(config, motion, 0.0), std::runtime_error);
  sim::OperatorConfig bad = config;
  bad.grip_factor = 0.0;
  EXPECT_THROW(hand::Hand(bad, motion, kStep), std::runtime_error);
}

}  // namespace hand_test
}  // namespace voxtouch::hd_sim
