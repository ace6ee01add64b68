// Identification through driver, gate and guard, on devices with known plants.
#include <gtest/gtest.h>

#include <Eigen/LU>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "devices/arm/simulated/simulated_arm.hpp"
#include "devices/arm/simulated/start_posture.hpp"
#include "devices/lwr/lwr_options.hpp"
#include "devices/lwr/simulated/lwr_plant.hpp"
#include "devices/registry.hpp"
#include "devices/sim/parameters.hpp"
#include "nodes/cli/identify/device_run.hpp"

namespace voxtouch::cli {
namespace {

namespace id = identification;

DeviceRunOptions options_for(const DeviceDescription& d) {
  DeviceRunOptions o;
  o.session.limits = {.period_s = 1.0 / d.rate_hz, .allowed_force_n = 0.2 * d.max_force_n};
  o.virtual_time = true;
  o.hand_check = false;
  return o;
}

devices::DeviceOptions released() {
  devices::DeviceOptions options;
  sim::OperatorConfig hand;
  hand.released = true;
  options.hand = hand;
  options.lockstep = true;
  return options;
}

void expect_within_a_tenth(const char* name, const sim::SimParameters& truth) {
  const auto driver = devices::open_device(name, released());
  const DeviceDescription& d = truth.description;
  const std::atomic<bool> stop{false};
  const DeviceRunResult r =
      run_identification(*driver, options_for(d), stop, [](const std::string&) {});
  ASSERT_EQ(r.outcome, id::Outcome::kMeasured);
  const double lag = d.force_bandwidth_hz < 1e6 ? 1.0 / (2.0 * M_PI * d.force_bandwidth_hz) : 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double mass = truth.mass_kg[static_cast<Eigen::Index>(a)];
    EXPECT_NEAR(r.axes[a].mass_kg.value, mass, 0.1 * mass);
    EXPECT_NEAR(r.axes[a].viscous_ns_per_m.value, d.damping_ns_per_m,
                std::max(0.03, 0.1 * d.damping_ns_per_m));
    EXPECT_NEAR(r.axes[a].coulomb_n.value, d.coulomb_friction_n, 0.1 * d.coulomb_friction_n);
    EXPECT_NEAR(r.axes[a].delay_s.value, d.delay_s + lag, 0.1 * (d.delay_s + lag));
    EXPECT_NEAR(r.encoder_step_m[a], d.position_resolution_m, 1e-6 * d.position_resolution_m);
  }
  EXPECT_EQ(r.guard_clamped, 0U);
}

TEST(Identify, SimPhantomHasItsFigures) {
  expect_within_a_tenth("sim-phantom", sim::sim_phantom());
}
TEST(Identify, SimLwrHasItsFigures) { expect_within_a_tenth("sim-lwr", sim::sim_lwr()); }

/// Apparent mass along each axis of a tool that is free on the others: 1 / (J M^-1 J^T)_aa
/// (Khatib, IEEE J. Robotics and Automation 3, 1987).
Vec3 apparent_mass(const Eigen::MatrixXd& mass, const Eigen::MatrixXd& jacobian) {
  return (jacobian * mass.inverse() * jacobian.transpose()).diagonal().cwiseInverse();
}

/// At the origin of D, at which the arm starts.
Vec3 lwr_mass() {
  const arm_sim::PlantParameters plant = lwr_sim::lwr_plant();
  const arm_sim::ArmDynamics dynamics(plant.bodies);
  const auto reach = [&](const arm::Joints& q) {
    const auto t = dynamics.at(q, arm::Joints::Zero());
    return arm_sim::Reach{t.tool, t.jacobian};
  };
  const arm::Joints posture = lwr::LwrOptions{}.posture.posture;
  Pose start = reach(posture).tool;
  start.position -= devices::usual_rest_in_d();
  const arm::Joints q =
      arm_sim::start_posture(reach, start, posture, plant.lowest_rad, plant.highest_rad);
  const auto terms = dynamics.at(q, arm::Joints::Zero());
  return apparent_mass(terms.mass, terms.jacobian.topRows(3));
}

TEST(Identify, EmulatedLwrHasTheMassAndDelayOfItsPlant) {
  const auto driver = devices::open_device("emulated-lwr", released());
  const std::atomic<bool> stop{false};
  const DeviceRunResult r = run_identification(*driver, options_for(driver->description()), stop,
                                               [](const std::string&) {});
  ASSERT_EQ(r.outcome, id::Outcome::kMeasured);
  const Vec3 mass = lwr_mass();
  const arm_sim::ArmConfig config;
  const double delay_s =
      (1 + config.torque_delay_ticks) * arm_sim::kTick + config.torque_lag_s;  // one tick waits
  for (std::size_t a = 0; a < 3; ++a) {
    const double expected = mass[static_cast<Eigen::Index>(a)];
    EXPECT_NEAR(r.axes[a].mass_kg.value, expected, 0.1 * expected);
    EXPECT_NEAR(r.axes[a].delay_s.value, delay_s, 0.1 * delay_s);
  }
}

TEST(Identify, CurvesHoldWhatTheFitLeaves) {
  const auto driver = devices::open_device("sim-phantom", released());
  DeviceRunOptions options = options_for(driver->description());
  options.session.axes = {true, false, false};
  options.with_curves = true;
  const std::atomic<bool> stop{false};
  const DeviceRunResult r = run_identification(*driver, options, stop, [](const std::string&) {});
  ASSERT_EQ(r.axes[0].outcome, id::Outcome::kMeasured);
  ASSERT_GE(r.curves[0].strokes.size(), 5U);
  double squares = 0.0, samples = 0.0, longest_m = 0.0;
  for (const id::Curve& c : r.curves[0].strokes) {
    ASSERT_EQ(c.times_s.size(), c.position_m.size());
    ASSERT_EQ(c.times_s.size(), c.residual_m.size());
    longest_m = std::max(longest_m, std::abs(c.position_m.back()));
    samples += static_cast<double>(c.residual_m.size());
    for (const double rest : c.residual_m)
      squares += rest * rest;
  }
  EXPECT_NEAR(std::sqrt(squares / samples), r.axes[0].residual_m, 0.02 * r.axes[0].residual_m);
  EXPECT_GT(longest_m, 100.0 * r.axes[0].residual_m);
  EXPECT_TRUE(r.curves[1].strokes.empty());
}

TEST(Identify, StopRequestEndsInZeroForce) {
  const auto driver = devices::open_device("sim-phantom", released());
  const std::atomic<bool> stop{true};
  const DeviceRunResult r = run_identification(*driver, options_for(driver->description()), stop,
                                               [](const std::string&) {});
  EXPECT_FALSE(r.problem.empty());
  const auto before = driver->read(std::chrono::microseconds(0));
  ASSERT_TRUE(before);
  EXPECT_EQ(before->twist.linear, Vec3::Zero());
}

}  // namespace
}  // namespace voxtouch::cli
