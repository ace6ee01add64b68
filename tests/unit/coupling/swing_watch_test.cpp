#include "core/coupling/swing_watch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <tuple>

#include "core/coupling/running_coupling.hpp"
#include "tests/unit/coupling/haptic_loop.hpp"

namespace voxtouch::coupling {
namespace swing_watch_test {

constexpr double kT = 1e-3;

CouplingLimits device_limits() {
  return {.max_force_n = 8.5, .max_torque_nm = 0.0, .resolution_m = 3e-5, .damping_ns_per_m = 0.05};
}

/// The paper's 5 Hz in a light hand, on a wall of 1000 N/m.
TEST(SwingWatch, FindsATooSlowFilter) {
  CouplingSpec spec;
  spec.cutoff_hz = 5;
  RunningCoupling coupling(spec, device_limits(), kT);
  LoopDevice device;
  device.mass_kg = 0.075, device.damping_ns_per_m = 0.05, device.resolution_m = 3e-5,
  device.push = Vec3(-1, 0, 0);
  device.hand_stiffness_n_per_m = 50, device.hand_damping_ns_per_m = 0.5;
  HapticLoop loop(device, coupling, [](const Vec3& at) { return wall(at, 1000); });
  loop.position = Vec3(0.005, 0, 0);
  for (int n = 0; n < 20'000; ++n)
    loop.step();
  const CouplingCounters& c = coupling.counters();
  std::printf("growing %d, swings %llu: %.2f Hz, %.1f mm, %.2f N, %.2f s\n", c.growing,
              static_cast<unsigned long long>(c.swing.swings), c.swing.frequency_hz,
              1e3 * c.swing.amplitude_m, c.swing.force_n, c.swing.duration_s);
  EXPECT_GE(c.swing.swings, 1U);
  EXPECT_NEAR(c.swing.frequency_hz, 4.2, 0.5);
}

/// Steady cycles with the force leading the motion by `lead_rad`, so that the coupling gives energy
/// if it is above 0. From cycle to cycle the size grows by `growth` and the frequency by `faster`.
SwingWatch cycles(double hz, double motion_m, double force_n, double lead_rad, double growth,
                  double seconds, double faster = 1.0, double slide_m_per_s = 0.0) {
  SwingWatch watch({.resolution_m = 1e-5,
                    .max_force_n = 10.0,
                    .damping_ns_per_m = 0.1,
                    .coulomb_friction_n = 0.0});
  double last = 0.0, cycle = 0.0;
  for (int n = 0; n < seconds / kT; ++n, cycle += hz * std::pow(faster, cycle) * kT) {
    const double size = std::pow(growth, cycle), angle = 2.0 * std::numbers::pi * cycle;
    const double x = motion_m * size * std::sin(angle),
                 force = force_n * size * (1.2 - std::sin(angle - lead_rad));
    watch.observe({.known = true,
                   .translation = Vec3(x - last, slide_m_per_s * kT, 0),
                   .rotation = Vec3::Zero()},
                  {force, 0, 0}, Vec3::UnitX(), kT, 0.0);
    last = x;
  }
  return watch;
}

TEST(SwingWatch, ReportsFrequencyAmplitudeForceAndDuration) {
  const SwingWatch watch = cycles(7.0, 1e-3, 0.5, 0.1, 1.0, 3.0);
  EXPECT_NEAR(watch.largest().frequency_hz, 7.0, 0.1);
  EXPECT_NEAR(watch.largest().amplitude_m, 2e-3, 2e-5);
  EXPECT_NEAR(watch.largest().force_n, 1.0, 0.02);
  EXPECT_NEAR(watch.largest().duration_s, 3.0, 0.4);
  EXPECT_EQ(watch.largest().swings, 1U);
  EXPECT_FALSE(watch.growing());
}

TEST(SwingWatch, FindsForceThatGrowsOverThreePeriods) {
  EXPECT_TRUE(cycles(7.0, 1e-3, 0.5, 0.1, 1.3, 1.5).growing());
  EXPECT_FALSE(cycles(7.0, 1e-3, 0.5, 0.1, 1.02, 1.5).growing());
  EXPECT_FALSE(cycles(7.0, 1e-3, 0.5, -0.3, 1.3, 1.5).growing()) << "the hand's work";
}

/// As over a texture whose waves pass faster and harder while the hand accelerates.
TEST(SwingWatch, GrowthNeedsCyclesOfAlikePeriod) {
  EXPECT_FALSE(cycles(3.0, 1e-3, 0.5, 0.1, 1.3, 1.0, 1.5).growing());
  EXPECT_TRUE(cycles(3.0, 1e-3, 0.5, 0.1, 1.3, 2.0, 1.1).growing());
}

/// Tremor and strokes: the hand supplies what the coupling dissipates.
TEST(SwingWatch, IsSilentIfTheHandMovesTheTool) {
  for (const double hz : {1.5, 3.0, 8.0, 10.0, 12.0}) {
    const SwingWatch watch = cycles(hz, 1e-3, 0.5, -0.2, 1.0, 4.0);
    EXPECT_EQ(watch.largest().swings, 0U) << hz;
  }
}

/// A loop that amplifies a tremor gives the hand a little energy. A swing gives a hand more, or
/// exceeds what tremor moves.
TEST(SwingWatch, TellsAnAmplifiedTremorFromASwing) {
  for (const double hz : {8.0, 10.0, 12.0}) {
    EXPECT_EQ(cycles(hz, 5e-4, 0.5, 0.1, 1.0, 4.0).largest().swings, 0U) << hz;
    EXPECT_GE(cycles(hz, 5e-4, 0.5, 0.3, 1.0, 4.0).largest().swings, 1U) << hz << ": gripped";
    EXPECT_GE(cycles(hz, 5e-4, 0.5, 3.8e-3 * hz, 1.0, 4.0).largest().swings, 1U)
        << hz << ": released";
    EXPECT_GE(cycles(hz, 2e-3, 0.5, 0.1, 1.0, 4.0).largest().swings, 1U) << hz << ": large";
  }
}

/// A swing while the hand slides slowly still counts. Where a cycle ends farther away than it is
/// large, the tool may pass the waves of a texture, whose energy is not conclusive.
TEST(SwingWatch, FindsASwingOnASlowSlideOnly) {
  EXPECT_EQ(cycles(7.0, 1e-3, 0.5, 0.1, 1.0, 3.0, 1.0, 0.012).largest().swings, 1U);
  EXPECT_EQ(cycles(7.0, 1e-3, 0.5, 0.1, 1.0, 3.0, 1.0, 0.016).largest().swings, 0U);
}

TEST(SwingWatch, CountsNoBounceOfTheEncoderAndNoDecay) {
  EXPECT_EQ(cycles(30.0, 1.2e-5, 0.5, 0.1, 1.0, 3.0).largest().swings, 0U);
  EXPECT_EQ(cycles(7.0, 1e-3, 0.5, 0.1, 0.9, 3.0).largest().swings, 0U);
}

/// A released device of 0.2 kg between two walls of 1000 N/m, 0.5 mm apart, with a late force.
SwingWatch between_walls(double damping_ns_per_m, double delay_s, double lag_s) {
  constexpr double kMassKg = 0.2, kWall = 1000.0, kGapM = 5e-4;
  SwingWatch watch({.resolution_m = 1e-6,
                    .max_force_n = 10.0,
                    .damping_ns_per_m = damping_ns_per_m,
                    .coulomb_friction_n = 0.0,
                    .delay_s = delay_s,
                    .force_lag_s = lag_s});
  const auto wall = [](double x) {
    return x > 0.5 * kGapM    ? -kWall * (x - 0.5 * kGapM)
           : x < -0.5 * kGapM ? -kWall * (x + 0.5 * kGapM)
                              : 0.0;
  };
  const double reached = lag_s > 0.0 ? -std::expm1(-kT / lag_s) : 1.0;
  const auto late = static_cast<std::size_t>(std::round(delay_s / kT));
  std::array<double, 8> commands{};
  double x = 0.0, v = 0.2, normal = 0.0, read_m = 0.0, force = 0.0;
  for (int n = 0; n < 4000; ++n) {
    const double command = std::clamp(wall(x), -4.0, 4.0), before_m = read_m;
    if (command != 0.0)
      normal = command < 0.0 ? -1.0 : 1.0;
    for (std::size_t i = commands.size() - 1; i > 0; --i)
      commands[i] = commands[i - 1];
    commands[0] = command;
    // Mean force of the period, and the force at its end.
    const double missing = commands[late] - force;
    const double mean =
        lag_s > 0.0 ? commands[late] - reached * lag_s / kT * missing : commands[late];
    force += reached * missing;
    const double gained = kT * (mean - damping_ns_per_m * v) / kMassKg;
    x += kT * (v + 0.5 * gained);
    v += gained;
    read_m = 1e-6 * std::round(1e6 * x);
    watch.observe(
        {.known = true, .translation = Vec3(read_m - before_m, 0, 0), .rotation = Vec3::Zero()},
        {command, 0, 0}, normal * Vec3::UnitX(), kT, 0.0);
  }
  const Swing& swing = watch.largest();
  std::printf("%.1f Hz, %.2f mm, %.2f N, growing %d\n", swing.frequency_hz, 1e3 * swing.amplitude_m,
              swing.force_n, watch.growing());
  return watch;
}

TEST(SwingWatch, FindsAToolThatBouncesBetweenTwoWalls) {
  for (const auto& [damping_ns_per_m, delay_s, lag_s] :
       {std::tuple{1.0, 5e-3, 0.0}, {2.5, 2e-3, 3e-3}}) {
    const Swing swing = between_walls(damping_ns_per_m, delay_s, lag_s).largest();
    EXPECT_GE(swing.swings, 1U) << lag_s;
    EXPECT_NEAR(swing.force_n, 8.0, 0.1) << "from one wall's push to the other's";
  }
}

/// Over waves the contact returns along the wall what it took across it.
TEST(SwingWatch, IsSilentOverATexture) {
  SwingWatch watch({.resolution_m = 1e-6,
                    .max_force_n = 10.0,
                    .damping_ns_per_m = 0.0,
                    .coulomb_friction_n = 0.0});
  Vec3 last = Vec3::Zero();
  for (int n = 0; n < 4000; ++n) {
    const double t = n * kT, along = 0.02 * t,
                 across = 1e-4 * std::sin(2.0 * std::numbers::pi * 7.0 * t);
    const Vec3 at(along, 0, across),
        force(0.3 * std::cos(2.0 * std::numbers::pi * 7.0 * t), 0, 0.5 + 2000.0 * across);
    watch.observe({.known = true, .translation = at - last, .rotation = Vec3::Zero()}, force,
                  Vec3::UnitZ(), kT, 0.0);
    last = at;
  }
  EXPECT_EQ(watch.largest().swings, 0U);
}

}  // namespace swing_watch_test
}  // namespace voxtouch::coupling
