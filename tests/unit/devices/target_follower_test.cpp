#include "devices/operator/target_follower.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include "devices/operator/hand.hpp"
#include "devices/sim/simulated_device.hpp"

namespace voxtouch::hand {
namespace {

constexpr double kPeriodS = 0.001;
constexpr double kMostSpeed = 0.5,
                 kMostRate = 3.0;  // [m/s], [rad/s]: a quick hand, far from a throw

Pose at(const Vec3& position, const Quat& orientation = Quat::Identity()) {
  return {position, orientation};
}

Quat turned(const Vec3& axis, double angle_rad) { return Quat(Eigen::AngleAxisd(angle_rad, axis)); }

/// A follower with its clock.
struct Led {
  TargetFollower follower{Pose{}, kPeriodS, {}};
  std::uint64_t periods = 0;
  double time_s() const { return static_cast<double>(periods) * kPeriodS; }
  void advance() {
    follower.advance({}, {});
    ++periods;
  }
  MotionPoint position() const { return follower.position_at(time_s()); }
  MotionOrientation turn() const { return follower.orientation_at(time_s()); }
};

/// Gain of the follower at a frequency, by correlation over whole periods.
double measured_gain(double frequency_hz, double amplitude_m) {
  Led led;
  std::complex<double> in, out;
  const double omega = 2.0 * std::numbers::pi * frequency_hz;
  for (int n = 0; n < 3'000; ++n) {
    const double target = amplitude_m * std::sin(omega * led.time_s());
    led.follower.aim(at({target, 0.0, 0.0}));
    if (n >= 1'000) {
      const std::complex<double> turn = std::polar(1.0, -omega * led.time_s());
      in += target * turn, out += led.position().position.x() * turn;
    }
    led.advance();
  }
  return std::abs(out) / std::abs(in);
}

/// For a minimum-jerk step with velocity 30 s^2 (1 - s)^2 and a target sampled eight times per
/// step: the transform of the first times the sinc of the second.
double gain_of_formula(double frequency_hz) {
  const double omega = 2.0 * std::numbers::pi * frequency_hz;
  const int periods = 12 * TargetFollower::kSteps;  // 0.1 s / 8 is 12.5 periods: 12 or 13 of them
  const double interval_s = kPeriodS * std::llround(periods / 96.0 * 12.5);
  const double step_s = TargetFollower::kSteps * interval_s;
  std::complex<double> sum;
  constexpr int kPieces = 10'000;
  for (int n = 0; n < kPieces; ++n) {
    const double s = (n + 0.5) / kPieces;
    sum += 30.0 * s * s * (1 - s) * (1 - s) / kPieces * std::polar(1.0, -omega * s * step_s);
  }
  return std::abs(sum);
}

TEST(TargetFollower, BandwidthIsBelowThatOfAHand) {
  const double down_3_db = 1.0 / std::numbers::sqrt2;
  for (const double frequency_hz : {1.0, 2.0, 4.0, 6.0, 8.0, 10.0, 15.0}) {
    const double interval_s = 0.013, x = std::numbers::pi * frequency_hz * interval_s;
    const double expected = gain_of_formula(frequency_hz) * std::sin(x) / x;
    EXPECT_NEAR(measured_gain(frequency_hz, 0.002), expected, 0.02) << frequency_hz << " Hz";
  }
  EXPECT_GT(measured_gain(6.0, 0.002), down_3_db);
  EXPECT_LT(measured_gain(7.5, 0.002), down_3_db);
  EXPECT_LT(measured_gain(10.0, 0.002), 0.55) << "voluntary motion of a hand ends at 10 Hz";
}

TEST(TargetFollower, ReachesAndKeepsItsTarget) {
  Led led;
  const Pose target = at({0.01, -0.02, 0.005}, turned(Vec3(1, 2, 2) / 3.0, 0.2));
  for (int n = 0; n < 1'000; ++n) {
    if (n < 250)
      led.follower.aim(target);
    led.advance();
  }
  EXPECT_LT((led.position().position - target.position).norm(), 1e-16);
  EXPECT_TRUE(led.position().velocity.isZero(0.0));
  EXPECT_LT(led.turn().orientation.angularDistance(target.orientation), 1e-7);
  EXPECT_TRUE(led.turn().rate.isZero(0.0));
}

TEST(TargetFollower, StaysInPlaceWithoutTargets) {
  Led led;
  led.follower.aim(at({10.0, 0.0, 0.0}));
  Vec3 after_rest = Vec3::Zero();
  for (int n = 0; n < 2'000; ++n) {
    led.advance();
    if (n == 299) {
      EXPECT_NEAR(led.position().velocity.x(), kMostSpeed, 0.01);
    }
    // 0.3 s, the running step, and the interval to the next one.
    if (n == 300 + 104 + 13)
      after_rest = led.position().position;
  }
  EXPECT_TRUE(led.position().velocity.isZero(0.0));
  EXPECT_EQ(led.position().position, after_rest);
  EXPECT_LT(after_rest.x(), 0.2) << "it stops 0.3 s after the last target, not at it";
}

/// Targets of any distance at any moment, with pauses.
template <class EachPeriod>
void drag_at_random(unsigned seed, int periods, EachPeriod&& each) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> anywhere(-1.0, 1.0);
  Led led;
  int next = 0;
  for (int n = 0; n < periods; ++n) {
    if (n == next) {
      const Vec3 axis = Vec3(anywhere(random), anywhere(random), 1.1).normalized();
      led.follower.aim(at({anywhere(random), anywhere(random), anywhere(random)},
                          turned(axis, 3.0 * anywhere(random))));
      next += 1 + static_cast<int>(random() % (random() % 8 == 0 ? 700 : 20));
    }
    led.advance();
    each(led);
  }
}

TEST(TargetFollower, MovesNoFasterThanItsBoundAndWithoutAJump) {
  // A step of length d has the peak acceleration 5.7735 d / T^2 (its derivative at (3 - sqrt 3) /
  // 6); eight steps one after the other, each at the bound of speed, never add up to more.
  const double d = kMostSpeed * 0.013, step_s = 0.104;
  const double most_acceleration = TargetFollower::kSteps * 5.7735 * d / (step_s * step_s);
  Vec3 before = Vec3::Zero(), velocity = Vec3::Zero();
  drag_at_random(5, 20'000, [&](const Led& led) {
    const MotionPoint now = led.position();
    ASSERT_LE(now.velocity.norm(), 1.02 * kMostSpeed);
    ASSERT_LE((now.position - before).norm(), 1.02 * kMostSpeed * kPeriodS);
    ASSERT_LE((now.velocity - velocity).norm(), most_acceleration * kPeriodS);
    ASSERT_LE(led.turn().rate.norm(), 1.02 * kMostRate);
    before = now.position, velocity = now.velocity;
  });
}

TEST(TargetFollower, RatesAreTheDerivativesOfThePose) {
  drag_at_random(6, 3'000, [&](const Led& led) {
    const double h = 1e-6, t = led.time_s() + 0.4 * kPeriodS;
    const Vec3 moved =
        led.follower.position_at(t + h).position - led.follower.position_at(t - h).position;
    ASSERT_LT((moved / (2 * h) - led.follower.position_at(t).velocity).norm(), 1e-6);
    const Quat turn = led.follower.orientation_at(t + h).orientation *
                      led.follower.orientation_at(t - h).orientation.conjugate();
    const Vec3 rate = (turn.w() < 0 ? -1.0 : 1.0) * turn.vec() / h;
    ASSERT_LT((rate - led.follower.orientation_at(t).rate).norm(), 1e-6);
  });
}

TEST(TargetFollower, IgnoresInvalidPoses) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  Led led;
  for (const Pose& bad : {at({nan, 0, 0}), at({0, inf, 0}), at({1, 0, 0}, Quat(0, 0, 0, 0)),
                          at({1, 0, 0}, Quat(nan, 0, 0, 1)), at({1, 0, 0}, Quat(1e9, 0, 0, 0))})
    for (int n = 0; n < 100; ++n)
      led.follower.aim(bad), led.advance();
  EXPECT_TRUE(led.position().position.isZero(0.0));
  EXPECT_EQ(led.turn().orientation.coeffs(), Quat::Identity().coeffs());
}

/// The device in front of a wall at x = 0.
struct AtAWall {
  explicit AtAWall(const sim::SimParameters& p, double wall_n_per_m = 500.0)
      : device(p, p.hand, start(), 1, true),
        stiffness_n_per_m(wall_n_per_m) {}
  static Motion start() {
    Motion rest;
    rest.path = {Vec3(-0.01, 0.0, 0.0)};
    return rest;
  }
  /// One period; returns the force.
  double step() {
    const double x = device.read(std::chrono::microseconds(0))->pose.position.x();
    const double force = -stiffness_n_per_m * std::max(0.0, x);
    (void)device.write({Vec3(force, 0.0, 0.0), Vec3::Zero()});
    return force;
  }
  sim::SimulatedDevice device;
  double stiffness_n_per_m;
};

TEST(LedDevice, PressesAsFarAsHandAndWallBalance) {
  const sim::SimParameters p = sim::sim_phantom();
  AtAWall at_wall(p);
  double force = 0.0;
  for (int n = 0; n < 3'000; ++n) {
    if (n % 16 == 0)
      at_wall.device.lead_hand(at({0.01, 0.0, 0.0}));
    force = at_wall.step();
  }
  // k_hand (x_target - x) = k_wall x, but for the device's dry friction.
  const double k = p.hand.stiffness_n_per_m;
  const double expected = -500.0 * k * 0.01 / (k + 500.0);
  EXPECT_NEAR(force, expected, p.description.coulomb_friction_n + 0.01);
}

/// The largest force of the last second, over that of the device, in front of a wall of a stiffness
/// with targets that are `depth_m` in it.
double press_ratio(const sim::SimParameters& p, double wall_n_per_m, double depth_m) {
  AtAWall at_wall(p, wall_n_per_m);
  double most = 0.0;
  for (int n = 0; n < 6'000; ++n) {
    if (n % 16 == 0)
      at_wall.device.lead_hand(at({depth_m, 0.0, 0.0}));
    const double force = std::abs(at_wall.step());
    EXPECT_LE(force, p.description.max_force_n);
    if (n >= 5'000)
      most = std::max(most, force);
  }
  return most / p.description.max_force_n;
}

TEST(LedDevice, ForceStaysBelowItsLimitForAnyTarget) {
  for (const sim::SimParameters& p : {sim::sim_phantom(), sim::sim_lwr()})
    for (const double wall_n_per_m : {30.0, 100.0, 500.0, 1'000.0})
      for (const double depth_m : {10.0, 1e17, 1e300}) {
        const double friction = p.description.coulomb_friction_n / p.description.max_force_n;
        EXPECT_NEAR(press_ratio(p, wall_n_per_m, depth_m), 0.3, friction + 0.003)
            << p.description.model << ", wall " << wall_n_per_m << " N/m, " << depth_m << " m";
      }
}

/// Led at full speed; the targets end when the wall is met.
TEST(LedDevice, YieldsAtRestAfterPressingTooHard) {
  const sim::SimParameters p = sim::sim_phantom();
  AtAWall at_wall(p);
  double force = 0.0;
  for (int n = 0; n < 3'000; ++n) {
    if (n % 16 == 0 && force == 0.0)
      at_wall.device.lead_hand(at({10.0, 0.0, 0.0}));
    force = std::abs(at_wall.step());
    EXPECT_LE(force, p.description.max_force_n);
  }
  EXPECT_LT(force, 0.3 * p.description.max_force_n + p.description.coulomb_friction_n + 0.02);
  EXPECT_GT(force, 0.5);
}

/// A torque against the rotation, as of a slot.
TEST(LedDevice, TorqueStaysBelowItsLimitForAnyTarget) {
  sim::SimParameters p = sim::sim_lwr();
  p.hand = *hand::grip("arm-firm");
  AtAWall free(p);
  double torque = 0.0;
  for (int n = 0; n < 4'000; ++n) {
    if (n % 16 == 0)
      free.device.lead_hand(at({-0.01, 0.0, 0.0}, turned(Vec3::UnitZ(), 3.0)));
    const Quat q = free.device.read(std::chrono::microseconds(0))->pose.orientation;
    torque = -100.0 * (q.w() < 0.0 ? -2.0 : 2.0) * q.z();
    (void)free.device.write({Vec3::Zero(), Vec3(0.0, 0.0, torque)});
  }
  EXPECT_NEAR(-torque / p.description.max_torque_nm, 0.3,
              p.coulomb_friction_nm / p.description.max_torque_nm + 0.005);
}

TEST(LedDevice, LosingItsTargetsInContactIsNoJumpOfForce) {
  AtAWall at_wall(sim::sim_phantom());
  std::vector<double> forces;
  for (int n = 0; n < 3'000; ++n) {
    if (n < 400 && n % 16 == 0)
      at_wall.device.lead_hand(at({0.02 * std::sin(0.02 * n), 0.0, 0.0}));
    forces.push_back(at_wall.step());
  }
  double while_led = 0.0, after = 0.0, last = 0.0;
  for (std::size_t n = 1; n < forces.size(); ++n) {
    double& most = n < 400 ? while_led : after;
    most = std::max(most, std::abs(forces[n] - forces[n - 1]));
    if (n > 1'500)
      last = std::max(last, std::abs(forces[n] - forces[n - 1]));
  }
  EXPECT_LE(after, while_led);
  EXPECT_LT(last, 0.02) << "it rests";
}

TEST(LedDevice, SameTargetsAreBitIdentical) {
  AtAWall first(sim::sim_lwr()), second(sim::sim_lwr());
  std::mt19937 random(9);
  std::uniform_real_distribution<double> anywhere(-0.05, 0.05);
  for (int n = 0; n < 3'000; ++n) {
    if (random() % 17 == 0) {
      const Pose target = at({anywhere(random), anywhere(random), anywhere(random)},
                             turned(Vec3::UnitY(), anywhere(random)));
      first.device.lead_hand(target), second.device.lead_hand(target);
    }
    ASSERT_EQ(first.step(), second.step());
    ASSERT_EQ(first.device.plant().pose().position, second.device.plant().pose().position);
    ASSERT_EQ(first.device.plant().pose().orientation.coeffs(),
              second.device.plant().pose().orientation.coeffs());
  }
}

TEST(LedDevice, RestsAtItsStartUntilTheFirstTarget) {
  AtAWall at_wall(sim::sim_phantom());
  for (int n = 0; n < 500; ++n)
    EXPECT_EQ(at_wall.step(), 0.0);
  EXPECT_EQ(at_wall.device.plant().pose().position, Vec3(-0.01, 0.0, 0.0));
}

}  // namespace
}  // namespace voxtouch::hand
