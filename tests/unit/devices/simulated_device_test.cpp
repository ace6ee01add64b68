#include "devices/sim/simulated_device.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace voxtouch::devices {
namespace simulated_device_test {

using std::chrono::microseconds;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Motion stay() {
  Motion motion;
  motion.path.push_back(Vec3::Zero());
  return motion;
}

sim::OperatorConfig released() {
  sim::OperatorConfig hand;
  hand.released = true;
  return hand;
}

sim::SimulatedDevice free_phantom() { return {sim::sim_phantom(), released(), stay()}; }

Wrench push_x(double newton) { return {Vec3(newton, 0, 0), Vec3::Zero()}; }

TEST(SimulatedDevice, StartsAtZeroAndEachWriteTakesOnePeriod) {
  sim::SimulatedDevice device = free_phantom();
  EXPECT_TRUE(device.simulated());
  for (int i = 0; i < 5; ++i) {
    const auto sample = device.read(microseconds(0));
    ASSERT_TRUE(sample);
    ASSERT_EQ(sample->time_ns, i * 1'000'000);
    ASSERT_TRUE(sample->pose_valid);
    ASSERT_TRUE(device.write({}));
  }
}

TEST(SimulatedDevice, ForceReachesTheToolAfterExactlyTheDelay) {
  for (const sim::SimParameters& p : {sim::sim_phantom(), sim::sim_lwr()}) {
    sim::SimulatedDevice device(p, released(), stay());
    const double ms = p.description.delay_s * 1e3;
    for (int i = 0; i < ms; ++i) {
      device.write(push_x(p.description.max_force_n));
      ASSERT_TRUE(device.applied().zero()) << p.description.model << " " << i;
    }
    device.write(push_x(p.description.max_force_n));
    EXPECT_GT(device.applied().force.x(), 0.0);
    EXPECT_GT(device.plant().twist().linear.x(), 0.0);
  }
}

TEST(SimulatedDevice, UnansweredReadAdvancesWithoutForce) {
  sim::SimulatedDevice device = free_phantom();
  device.read(microseconds(0));
  device.write(push_x(1.0));
  device.write(push_x(1.0));
  EXPECT_EQ(device.applied().force.x(), 1.0);
  EXPECT_EQ(device.read(microseconds(0))->time_ns, 2'000'000);
  EXPECT_EQ(device.read(microseconds(0))->time_ns, 3'000'000);  // the pending command arrives
  EXPECT_EQ(device.applied().force.x(), 1.0);
  device.read(microseconds(0));
  EXPECT_TRUE(device.applied().zero());
}

TEST(SimulatedDevice, RefusesANanCommandAndGivesZeroForThatPeriod) {
  for (int axis = 0; axis < 6; ++axis) {
    sim::SimulatedDevice device(sim::sim_lwr(), released(), stay());
    sim::SimulatedDevice quiet(sim::sim_lwr(), released(), stay());
    Wrench bad = push_x(1.0);
    (axis < 3 ? bad.force : bad.torque)[axis % 3] = kNan;
    ASSERT_TRUE(device.write(bad) == std::unexpected(DeviceError::kNotFinite));
    ASSERT_TRUE(quiet.write({}));
    ASSERT_EQ(device.time_ns(), 1'000'000);
    for (int i = 0; i < 10; ++i) {
      device.write({}), quiet.write({});
      ASSERT_TRUE(device.applied().zero());
      ASSERT_EQ(device.plant().pose().position, quiet.plant().pose().position);
    }
  }
}

TEST(SimulatedDevice, CommandBeyondTheLimitGivesZeroForce) {
  sim::SimulatedDevice device = free_phantom();
  EXPECT_TRUE(device.write(push_x(8.5)));
  EXPECT_TRUE(device.write(push_x(8.6)) == std::unexpected(DeviceError::kLimit));
  EXPECT_EQ(device.applied().force.x(), 8.5);
  EXPECT_TRUE(device.write({}));
  EXPECT_TRUE(device.applied().zero());
  const Wrench torque{Vec3::Zero(), Vec3(1e-9, 0, 0)};
  EXPECT_TRUE(device.write(torque) == std::unexpected(DeviceError::kLimit))
      << "it has no torque motors";
}

TEST(SimulatedDevice, StopIsImmediateAndIdempotent) {
  sim::SimulatedDevice device(sim::sim_lwr(), released(), stay());
  for (int i = 0; i < 50; ++i)
    device.write({Vec3(50, 0, 0), Vec3(0, 5, 0)});
  EXPECT_GT(device.applied().force.x(), 40.0);
  device.stop();
  device.stop();
  EXPECT_TRUE(device.applied().zero());
  for (int i = 0; i < 10; ++i) {
    device.read(microseconds(0));
    EXPECT_TRUE(device.applied().zero());
  }
  EXPECT_TRUE(device.write(push_x(1.0)));
}

TEST(SimulatedDevice, ReportsQuantisedPositionsThatFollowTheTruth) {
  Motion motion;
  motion.path = {Vec3::Zero(), Vec3(0.03, 0.02, -0.01)};
  const sim::SimParameters p = sim::sim_phantom();
  sim::SimulatedDevice device(p, p.hand, motion);
  const double r = p.description.position_resolution_m;
  for (int i = 0; i < 1500; ++i) {
    const auto sample = device.read(microseconds(0));
    const Vec3 truth = device.plant().pose().position;
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_EQ(sample->pose.position[axis], std::round(truth[axis] / r) * r);
    }
    ASSERT_LT((sample->twist.linear - device.plant().twist().linear).norm(), 0.03) << i;
    device.write({});
  }
  EXPECT_GT(device.plant().pose().position.x(), 0.029);
}

/// Everything a run gives, as bytes.
std::vector<unsigned char> trace(std::uint64_t seed, double tremor_n) {
  Motion motion;
  motion.path = {Vec3(0.01, 0, 0), Vec3(-0.01, 0.02, 0)};
  const sim::SimParameters p = sim::sim_lwr();
  sim::OperatorConfig hand = p.hand;
  hand.tremor_n = tremor_n;
  sim::SimulatedDevice device(p, hand, motion, seed);
  std::vector<unsigned char> bytes;
  for (int i = 0; i < 2000; ++i) {
    const DeviceSample s = *device.read(microseconds(0));
    const double row[13] = {s.pose.position.x(),    s.pose.position.y(),    s.pose.position.z(),
                            s.pose.orientation.w(), s.pose.orientation.x(), s.pose.orientation.y(),
                            s.pose.orientation.z(), s.twist.linear.x(),     s.twist.linear.y(),
                            s.twist.linear.z(),     s.twist.angular.x(),    s.twist.angular.y(),
                            s.twist.angular.z()};
    const auto* raw = reinterpret_cast<const unsigned char*>(row);
    bytes.insert(bytes.end(), raw, raw + sizeof row);
    device.write({Vec3(20.0 * std::max(0.0, -s.pose.position.x() * 100.0), 0, 0), Vec3(0, 0, 0.5)});
  }
  return bytes;
}

TEST(SimulatedDevice, RestartIsBitIdentical) {
  EXPECT_EQ(trace(5, 0.3), trace(5, 0.3));
  EXPECT_EQ(trace(1, 0.0), trace(2, 0.0)) << "no tremor, no randomness";
  EXPECT_NE(trace(1, 0.3), trace(2, 0.3));
}

TEST(SimulatedDevice, PhantomFollowsTheHandAndLwrTheTorque) {
  const sim::SimParameters phantom = sim::sim_phantom(), lwr = sim::sim_lwr();
  Motion motion = stay();
  motion.orientation = Quat(Eigen::AngleAxisd(0.4, Vec3::UnitZ()));
  sim::SimulatedDevice pen(phantom, phantom.hand, motion);
  for (int i = 0; i < 500; ++i)
    pen.write(push_x(3.0));
  EXPECT_EQ(pen.plant().pose().orientation.coeffs(), motion.orientation.coeffs());
  EXPECT_LT(pen.read(microseconds(0))->pose.orientation.angularDistance(motion.orientation), 1e-3);
  sim::SimulatedDevice arm(lwr, lwr.hand, stay());
  for (int i = 0; i < 3000; ++i)
    arm.write({Vec3::Zero(), Vec3(1.0, 0, 0)});
  const double angle = 2.0 * std::asin(arm.plant().pose().orientation.x());
  EXPECT_NEAR(angle, 1.0 / 5.0,
              (0.1 + 0.01) / 5.0);  // torque over the hand's stiffness, friction apart
}

TEST(SimulatedDevice, DefaultsAreThoseOfTheDocumentedDevices) {
  const sim::SimParameters phantom = sim::sim_phantom(), lwr = sim::sim_lwr();
  EXPECT_EQ(phantom.description.max_torque_nm, 0.0);
  EXPECT_EQ(phantom.description.output_dof, 3U);
  EXPECT_NEAR(1.0 / (2.0 * std::numbers::pi * lwr.description.force_bandwidth_hz), 0.003, 1e-12);
  for (const sim::SimParameters& p : {phantom, lwr}) {
    EXPECT_GE(p.mass_kg.minCoeff(), p.description.mass_min_kg);
    EXPECT_LE(p.mass_kg.maxCoeff(), p.description.mass_max_kg);
  }
}

template <class Change>
std::string sentence(Change change) {
  sim::SimParameters p = sim::sim_lwr();
  Motion motion = stay();
  change(p, motion);
  try {
    sim::SimulatedDevice device(p, p.hand, motion);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(SimulatedDevice, NamesInvalidParameters) {
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(sentence([](auto& p, auto&) { p.hand.stiffness_n_per_m = -1.0; }),
                  "hand stiffness_n_per_m is -1"));
  EXPECT_TRUE(
      has(sentence([](auto& p, auto&) { p.hand.release_time_s = kNan; }), "release_time_s"));
  EXPECT_TRUE(has(sentence([](auto&, auto& m) { m.path.clear(); }), "way point"));
  EXPECT_TRUE(has(sentence([](auto&, auto& m) { m.path[0].z() = kNan; }), "finite"));
  EXPECT_TRUE(has(sentence([](auto&, auto& m) { m.speed_m_per_s = 0.0; }), "speed"));
  EXPECT_TRUE(has(sentence([](auto&, auto& m) { m.hold_s = -1.0; }), "hold"));
  EXPECT_TRUE(has(sentence([](auto&, auto& m) { m.repeat_from = 1; }), "way point"));
  EXPECT_TRUE(
      has(sentence([](auto&, auto& m) { m.orientation.coeffs().setZero(); }), "not a rotation"));
}

}  // namespace simulated_device_test
}  // namespace voxtouch::devices
