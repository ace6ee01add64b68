#include "devices/sim/plant.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

namespace voxtouch::devices {
namespace {

constexpr double kDt = 125e-6;

Motion stay(const Vec3& at = Vec3::Zero()) {
  Motion motion;
  motion.path.push_back(at);
  return motion;
}

sim::SimParameters ideal(double mass) {  // no damping, no friction
  sim::SimParameters p;
  p.mass_kg = Vec3::Constant(mass);
  p.description.damping_ns_per_m = p.description.coulomb_friction_n = 0.0;
  return p;
}

sim::OperatorConfig spring(double mass, double damping, double stiffness) {
  sim::OperatorConfig hand;
  hand.mass_kg = mass, hand.damping_ns_per_m = damping, hand.stiffness_n_per_m = stiffness;
  hand.inertia_kg_m2 = 1e-4, hand.stiffness_nm_per_rad = 0.5;
  return hand;
}

sim::OperatorConfig released() {
  sim::OperatorConfig hand;
  hand.released = true;
  return hand;
}

void run(sim::SimPlant& plant, const Wrench& push, int substeps, int from = 0) {
  for (int i = 0; i < substeps; ++i)
    plant.step(push, Vec3::Zero(), (from + i) * kDt, kDt);
}

TEST(Plant, UndampedSpringKeepsItsEnergy) {
  sim::SimPlant plant(ideal(0.075), spring(0.1, 0.0, 300.0), stay());
  plant.set_state({Vec3(0.01, -0.02, 0.005), Quat::Identity()}, {Vec3(0.1, 0, -0.2), Vec3::Zero()});
  const double before = plant.energy(0.0);
  run(plant, {}, 200'000);
  EXPECT_NEAR(plant.energy(25.0), before, 1e-10 * before);
}

TEST(Plant, UndampedRotationKeepsItsEnergy) {
  sim::SimPlant plant(ideal(0.075), spring(0.1, 0.0, 300.0), stay());
  plant.set_state({Vec3::Zero(), Quat(Eigen::AngleAxisd(0.3, Vec3(1, 2, 2) / 3.0))}, {});
  const double before = plant.energy(0.0);
  double most = 0.0;
  for (int i = 0; i < 80'000; ++i) {
    plant.step({}, Vec3::Zero(), i * kDt, kDt);
    most = std::max(most, std::abs(plant.energy(i * kDt) - before));
  }
  EXPECT_LT(most, 1e-3 * before);
  EXPECT_NEAR(plant.pose().orientation.norm(), 1.0, 1e-14);
}

TEST(Plant, FrictionOnlyTakesEnergy) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int attempt = 0; attempt < 200; ++attempt) {
    sim::SimParameters p = ideal(1.0);
    p.mass_kg = Vec3(6.0, 0.05, 1.0 + 0.9 * any(random));
    p.description.coulomb_friction_n = std::pow(10.0, 2.0 * any(random));
    p.coulomb_friction_nm = std::pow(10.0, 2.0 * any(random) - 3.0);
    sim::SimPlant plant(p, spring(0.1, 0.0, 2000.0), stay());
    plant.set_state(
        {0.02 * Vec3(any(random), any(random), any(random)), Quat::Identity()},
        {Vec3(any(random), any(random), any(random)), Vec3(any(random), any(random), any(random))});
    const double start = plant.energy(0.0);
    double energy = start;
    for (int i = 0; i < 4000; ++i) {
      plant.step({}, Vec3::Zero(), i * kDt, kDt);
      const double now = plant.energy(i * kDt);
      ASSERT_LE(now, energy + 1e-13 * start) << "trial " << attempt << " substep " << i;
      energy = now;
    }
    ASSERT_LT(energy, start);
  }
}

TEST(Plant, AtRestUnderLessThanTheFrictionStaysExactlyThere) {
  sim::SimParameters p = ideal(0.075);
  p.description.coulomb_friction_n = 0.04;
  p.coulomb_friction_nm = 0.1;
  const Vec3 at(0.0123, -0.0456, 0.0789);
  sim::SimPlant plant(p, spring(0.1, 4.0, 300.0), stay(at));
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> any(-0.023, 0.023);
  for (int i = 0; i < 20'000; ++i)
    plant.step(
        {Vec3(any(random), any(random), any(random)), Vec3(any(random), any(random), any(random))},
        Vec3::Zero(), i * kDt, kDt);
  EXPECT_EQ(plant.pose().position, at);
  EXPECT_EQ(plant.pose().orientation.coeffs(), Quat::Identity().coeffs());
  EXPECT_TRUE(plant.twist().linear.isZero(0.0));
  run(plant, {Vec3(0.041, 0, 0), Vec3::Zero()}, 10);
  EXPECT_GT(plant.pose().position.x(), at.x());
}

TEST(Plant, SlidingBodyStopsByTheClosedForm) {
  sim::SimParameters p = ideal(2.0);
  p.description.coulomb_friction_n = 3.0;
  sim::SimPlant plant(p, released(), stay());
  plant.set_state({}, {Vec3(0.3, 0.4, 0), Vec3::Zero()});
  const double stop_s = 2.0 * 0.5 / 3.0, displacement = 0.5 * 0.5 * stop_s;
  run(plant, {}, static_cast<int>(stop_s / kDt) - 2);
  EXPECT_GT(plant.twist().linear.norm(), 0.0);
  run(plant, {}, 5);
  EXPECT_TRUE(plant.twist().linear.isZero(0.0));
  EXPECT_NEAR(plant.pose().position.norm(), displacement, 1e-7);
  EXPECT_NEAR(plant.pose().position.y() / plant.pose().position.x(), 4.0 / 3.0, 1e-12);
}

TEST(Plant, ConstantForceOnAFreeMassGivesAParabola) {
  sim::SimPlant plant(ideal(0.075), released(), stay());
  run(plant, {Vec3(0.2, 0, -0.1), Vec3::Zero()}, 8000);
  EXPECT_NEAR(plant.pose().position.x(), 0.5 * 0.2 / 0.075, 1e-11);
  EXPECT_NEAR(plant.pose().position.z(), -0.5 * 0.1 / 0.075, 1e-11);
  EXPECT_NEAR(plant.twist().linear.x(), 0.2 / 0.075, 1e-11);
}

TEST(Plant, ConstantForceOnADampedMassGivesTheClosedForm) {
  sim::SimParameters p = ideal(5.0);
  p.description.damping_ns_per_m = 30.0;
  sim::SimPlant plant(p, released(), stay());
  run(plant, {Vec3(0, 12, 0), Vec3::Zero()}, 4000);
  const double t = 0.5, decay = std::exp(-30.0 / 5.0 * t);
  EXPECT_NEAR(plant.twist().linear.y(), 12.0 / 30.0 * (1.0 - decay), 1e-7);
  EXPECT_NEAR(plant.pose().position.y(), 12.0 / 30.0 * (t - 5.0 / 30.0 * (1.0 - decay)), 1e-7);
}

TEST(Plant, HandSpringDecaysByTheClosedForm) {
  sim::SimPlant plant(ideal(0.075), spring(0.1, 2.0, 300.0), stay());
  plant.set_state({Vec3(0.01, 0, 0), Quat::Identity()}, {});
  const double mass = 0.175, sigma = 2.0 / (2.0 * mass),
               wd = std::sqrt(300.0 / mass - sigma * sigma);
  for (int i = 1; i <= 4000; ++i) {
    plant.step({}, Vec3::Zero(), (i - 1) * kDt, kDt);
    const double t = i * kDt;
    const double expected =
        0.01 * std::exp(-sigma * t) * (std::cos(wd * t) + sigma / wd * std::sin(wd * t));
    ASSERT_NEAR(plant.pose().position.x(), expected, 1e-6) << i;
  }
}

TEST(Plant, HandRotatesTheToolAtTheExactFrequency) {
  sim::SimParameters p = ideal(1.0);
  p.inertia_kg_m2 = 1e-4;
  sim::SimPlant plant(p, spring(0.1, 4.0, 300.0), stay());
  plant.set_state({Vec3::Zero(), Quat(Eigen::AngleAxisd(0.02, Vec3::UnitY()))}, {});
  const double w = std::sqrt(0.5 / 2e-4);
  for (int i = 1; i <= 4000; ++i) {
    plant.step({}, Vec3::Zero(), (i - 1) * kDt, kDt);
    ASSERT_NEAR(2.0 * std::asin(plant.pose().orientation.y()), 0.02 * std::cos(w * i * kDt), 2e-5)
        << i;
  }
}

TEST(Plant, HandFollowsItsMotionAndTheToolKeepsItsOrientation) {
  Motion motion;
  motion.path = {Vec3(0.05, 0, 0), Vec3(-0.03, 0.01, 0.02)};
  motion.orientation = Quat(0.5, 0.5, -0.5, 0.5);
  const sim::SimParameters p = sim::sim_phantom();
  sim::SimPlant plant(p, p.hand, motion);
  EXPECT_EQ(plant.pose().position, motion.path.front());
  run(plant, {}, 8 * 8000);
  EXPECT_LT((plant.pose().position - motion.path.back()).norm(),
            0.04 / 300.0 + 1e-9);  // friction over stiffness
  EXPECT_EQ(plant.pose().orientation.coeffs(), motion.orientation.coeffs());
}

TEST(Plant, ReleaseRemovesTheHandsMassAndSpring) {
  sim::OperatorConfig hand = spring(0.1, 0.0, 300.0);
  hand.release_time_s = 0.01;
  sim::SimPlant plant(ideal(0.075), hand, stay());
  run(plant, {}, 80);
  EXPECT_TRUE(plant.held_at(0.0099));
  EXPECT_FALSE(plant.held_at(0.01));
  plant.set_state({Vec3(0.1, 0, 0), Quat::Identity()}, {});
  run(plant, {Vec3(0.3, 0, 0), Vec3::Zero()}, 8, 80);
  EXPECT_NEAR(plant.twist().linear.x(), 0.3 / 0.075 * 1e-3, 1e-12);
}

TEST(Plant, AnyStepIsStable) {
  sim::SimParameters p = ideal(0.05);
  p.description.coulomb_friction_n = 0.04;
  sim::SimPlant plant(p, spring(0.0, 50.0, 1e7), stay());
  plant.set_state({Vec3(0.01, 0.01, 0.01), Quat::Identity()}, {});
  for (int i = 0; i < 10'000; ++i)
    plant.step({}, Vec3::Zero(), i * 0.01, 0.01);
  EXPECT_LE(plant.pose().position.norm(), 0.0174);
}

}  // namespace
}  // namespace voxtouch::devices
