/// Does the simulated device behave in a loop as theory predicts? The filter is implemented here,
/// without rendering code.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "devices/force_guard.hpp"
#include "devices/sim/simulated_device.hpp"

namespace voxtouch::devices {
namespace {

using std::chrono::microseconds;
constexpr double kInf = std::numeric_limits<double>::infinity();

/// Second-order low-pass, trapezoidal rule in increments.
struct Pt2 {
  double w0, damping, gain, period;
  double y = 0.0, v = 0.0, last = 0.0;
  double step(double u) {
    const double g = 0.5 * w0 * period, c = 2.0 * (2.0 * damping + g),
                 gd = g / (1.0 + g * (2.0 * damping + g));
    const double dv = gd * (gain * (u + last) - 2.0 * y - c * v);
    y += g * (2.0 * v + dv), v += dv, last = u;
    return y;
  }
};

// -------------------------------------------------------------------------------------------------
// Linear loops with a limit stiffness from the eigenvalues of the exact sampled system (50 digits):
// the simulation must decay just below it and grow just above. This checks mass, damping, hand,
// delay, lag and hold at once.

struct LinearCase {
  const char* what;
  double m, b, m_h, b_h, k_h, period, delay, lag, w0, d, gain, k_crit;
};

/// Amplitude late in the run over the amplitude in its middle.
double growth(const LinearCase& c, double k, double run_s) {
  sim::SimParameters p;
  p.description.rate_hz = 1.0 / c.period;
  p.description.max_force_n = 1e9;
  p.description.damping_ns_per_m = c.b;
  p.description.delay_s = c.delay;
  p.description.force_bandwidth_hz = c.lag > 0.0 ? 1.0 / (2.0 * std::numbers::pi * c.lag) : kInf;
  p.mass_kg = Vec3::Constant(c.m);
  sim::OperatorConfig hand;
  hand.mass_kg = c.m_h, hand.damping_ns_per_m = c.b_h, hand.stiffness_n_per_m = c.k_h;
  hand.released = c.k_h == 0.0;
  Motion motion;
  motion.path.push_back(Vec3::Zero());
  sim::SimulatedDevice device(p, hand, motion);
  Pt2 filter{c.w0, c.d, c.gain, c.period};
  double middle = 0.0, late = 0.0;
  const int periods = static_cast<int>(run_s / c.period);
  for (int i = 0; i < periods; ++i) {
    const double x = device.read(microseconds(0))->pose.position.x();
    if (std::abs(x) > 100.0)
      return kInf;  // before the device's limits end the linear loop
    if (i > periods / 4 && i <= periods / 2)
      middle = std::max(middle, std::abs(x));
    if (i > 3 * periods / 4)
      late = std::max(late, std::abs(x));
    (void)device.write({Vec3((i == 0 ? 1.0 : 0.0) - filter.step(k * x), 0, 0), Vec3::Zero()});
  }
  return late / middle;
}

TEST(ClosedLoop, LimitStiffnessIsThatOfTheExactSampledModel) {
  constexpr double w5 = 2 * std::numbers::pi * 5;
  const std::vector<LinearCase> cases = {
      {"pen grip, 5 Hz", 0.075, 0.005, 0.1, 3, 200, 1e-3, 1e-3, 0, w5, 1, 1, 209.26866},
      {"firm grip, 5 Hz", 0.075, 0.005, 0.2, 8, 800, 1e-3, 1e-3, 0, w5, 1, 1, 1372.04493},
      {"pen grip, 50 Hz", 0.075, 0.005, 0.1, 3, 200, 1e-3, 1e-3, 0, 10 * w5, 0.707, 1, 508.236},
      {"2 kHz, 100 Hz, no delay", 0.05, 0.5, 0, 0, 0, 5e-4, 0, 0, 20 * w5, 0.577, 1, 238.0992},
      {"robot free, 5 Hz", 5, 30, 0, 0, 0, 1e-3, 2e-3, 3e-3, w5, 1, 1, 508.99308},
      {"robot held, 5 Hz", 5, 30, 1, 10, 200, 1e-3, 2e-3, 3e-3, w5, 1, 1, 729.7698},
      {"robot, gain 0.1", 5, 30, 0, 0, 0, 1e-3, 2e-3, 3e-3, w5, 1, 0.1, 5089.93077},
      {"500 Hz, heavy", 10, 10, 0, 0, 0, 2e-3, 0, 0, w5, 0.707, 1, 217.55006},
  };
  for (const LinearCase& c : cases) {
    EXPECT_LT(growth(c, 0.985 * c.k_crit, 60.0), 1.0) << c.what;
    EXPECT_GT(growth(c, 1.015 * c.k_crit, 60.0), 1.0) << c.what;
  }
}

// -------------------------------------------------------------------------------------------------
// A wall, a filter, the guard and the whole device: quantised, with friction, saturating. The hand
// moves into the wall and stays there.

struct WallResult {
  double ripple_n = 0.0;  ///< peak to peak of the force in the last second
  double mean_n = 0.0;
};

WallResult press_wall(const sim::SimParameters& p, const sim::OperatorConfig& hand, double k,
                      double into_m, double seconds = 5.0) {
  Motion motion;
  motion.path = {Vec3(0.02, 0, 0), Vec3(-into_m, 0, 0)};  // the wall fills x < 0
  sim::SimulatedDevice device(p, hand, motion);
  ForceGuard guard(guard_config(p.description));
  const double period = 1.0 / p.description.rate_hz;
  Pt2 filter{2 * std::numbers::pi * 100, std::numbers::sqrt2 / 2, 1.0, period};
  const int periods = static_cast<int>(seconds / period),
            last_second = static_cast<int>(1.0 / period);
  double low = kInf, high = -kInf, sum = 0.0;
  for (int i = 0; i < periods; ++i) {
    const DeviceSample sample = *device.read(microseconds(0));
    const double force = filter.step(
        std::min(k * std::max(0.0, -sample.pose.position.x()), p.description.max_force_n));
    const GuardInput input{{Vec3(force, 0, 0), Vec3::Zero()}, sample.time_ns + 3'000'000};
    const Wrench out = guard.pass(input, sample.time_ns);
    EXPECT_TRUE(device.write(out));
    if (i < periods - last_second)
      continue;
    low = std::min(low, out.force.x()), high = std::max(high, out.force.x()), sum += out.force.x();
  }
  return {high - low, sum / last_second};
}

bool quiet(const sim::SimParameters& p, const WallResult& r) {
  return r.ripple_n <= 0.02 * p.description.max_force_n;
}

TEST(ClosedLoop, PhantomInAPenGripRestsOnAWall) {
  const sim::SimParameters p = sim::sim_phantom();
  for (double k : {300.0, 400.0}) {
    const WallResult r = press_wall(p, p.hand, k, 0.01);
    EXPECT_TRUE(quiet(p, r)) << k << " N/m ripples by " << r.ripple_n << " N";
    EXPECT_NEAR(r.mean_n, k * 300.0 / (k + 300.0) * 0.01, 0.04 + k * 3e-5)
        << "springs in series, friction, one step";
  }
}

TEST(ClosedLoop, LwrHeldByAnArmRestsOnAWall) {
  const sim::SimParameters p = sim::sim_lwr();
  const WallResult r = press_wall(p, p.hand, 1500.0, 0.05);
  EXPECT_TRUE(quiet(p, r)) << r.ripple_n << " N";
  EXPECT_NEAR(r.mean_n, 1500.0 * 200.0 / 1700.0 * 0.05, 3.1);
}

TEST(ClosedLoop, TooStiffWallDoesNotRest) {
  const sim::SimParameters p = sim::sim_phantom();
  sim::OperatorConfig light = p.hand;
  light.mass_kg = 0.02, light.damping_ns_per_m = 0.5, light.stiffness_n_per_m = 20.0;
  EXPECT_FALSE(quiet(p, press_wall(p, light, 5000.0, 0.01)));
  const sim::SimParameters robot = sim::sim_lwr();
  EXPECT_FALSE(quiet(robot, press_wall(robot, robot.hand, 30'000.0, 0.05)));
}

}  // namespace
}  // namespace voxtouch::devices
