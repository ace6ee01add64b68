// A lever with a resting handle is rotated against a stop: a sound contact that moves energy from
// rotation to force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <numbers>
#include <string>

#include "core/coupling/passivity.hpp"
#include "tests/hard/loop/named_device.hpp"
#include "tests/support/loop_rig/loop_rig.hpp"

namespace voxtouch::long_runs {
namespace {

constexpr double kVoxelM = 0.002;

struct Turned {
  double lowest_j = 0.0, highest_j = 0.0,
         bound_j = 0.0;  ///< of the port: the hand's work, and the debt of a sound contact
  double largest_n = 0.0, late_n = 0.0;  ///< of the command; at the end
  double late_mm = 0.0;                  ///< of the handle in the last second, peak to peak
};

/// Rotated by `degrees` in two seconds, and back after two.
Turned turn(const std::string& device, int lever_mm, double degrees) {
  RigOptions options;
  options.scene = std::string(VOXTOUCH_STABILITY) + "/lever" + std::to_string(lever_mm) + ".yaml";
  options.device = named_device(device);
  Motion motion;
  motion.path = {Vec3::Zero()}, motion.hold_s = 8.0;
  motion.turn = {.axis = Vec3::UnitZ(),
                 .angle_rad = -degrees * std::numbers::pi / 180.0,
                 .from_s = 1.0,
                 .to_s = 3.0};
  options.path = motion;
  LoopRig rig(options);
  Turned out;
  const double rate = rig.device_description().rate_hz;
  double low = 1e9, high = -1e9;
  for (int n = 0; n < 6.0 * rate; ++n) {
    const double force = rig.step().force.norm();
    const coupling::CouplingOutput& made = rig.front().out();
    const double energy_j = made.energy_j + made.energy_rotation_j;
    out.lowest_j = std::min(out.lowest_j, energy_j),
    out.highest_j = std::max(out.highest_j, energy_j);
    out.largest_n = std::max(out.largest_n, force), out.late_n = force;
    if (n < 5.0 * rate)
      continue;
    const double at = 1e3 * rig.device().plant().pose().position.y();
    low = std::min(low, at), high = std::max(high, at);
  }
  const coupling::CouplingCounters& c = rig.front().counters();
  out.bound_j = coupling::energy_bound_j(c.most_force_n, c.longest_path_m, kVoxelM) +
                coupling::energy_bound_rotation_j(c.most_torque_nm, c.longest_rotation_rad,
                                                  c.most_force_n, kVoxelM);
  out.late_mm = high - low;
  return out;
}

class Levers : public testing::TestWithParam<const char*> {};

TEST_P(Levers, RotationAgainstAStopGivesNoEnergy) {
  for (const int lever_mm : {40, 80, 150})
    for (const double degrees : {5.0, 10.0, 20.0, 30.0}) {
      const Turned t = turn(GetParam(), lever_mm, degrees);
      std::printf(
          "%s, %d mm, %.0f degrees: energy %.4f to %.4f J, bound %.4f J; %.2f N at most, %.2f N "
          "and %.3f mm at the end\n",
          GetParam(), lever_mm, degrees, t.lowest_j, t.highest_j, t.bound_j, t.largest_n, t.late_n,
          t.late_mm);
      EXPECT_GE(t.lowest_j, -t.bound_j) << lever_mm << " mm, " << degrees << " degrees";
      EXPECT_LE(t.late_mm, 0.5) << lever_mm << " mm, " << degrees << " degrees";
    }
}

INSTANTIATE_TEST_SUITE_P(Devices, Levers,
                         testing::Values("sim-lwr", "virtuose_6d", "sim-phantom", "omega_6",
                                         "touch"));

}  // namespace
}  // namespace voxtouch::long_runs
