// Oscillating loops: reports from the ring, each as function calls with the correct behaviour.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "core/scene/device_file.hpp"
#include "devices/operator/hand.hpp"
#include "tests/support/loop_rig/loop_rig.hpp"
#include "tests/support/loop_rig/wall_loop.hpp"

namespace voxtouch::long_runs {
namespace {

struct Row {
  double position_m = 0.0;  ///< of the tool along the tested axis, before the encoder
  double force_n = 0.0;     ///< commanded, its size
  double along_n = 0.0;     ///< commanded, along that axis
  double injected_n = 0.0;
};

struct Swing {
  double position_m = 0.0, force_n = 0.0;  ///< peak to peak
  double largest_n = 0.0;
};

std::string file(const std::string& name) { return std::string(VOXTOUCH_STABILITY) + "/" + name; }

RigOptions ask(const std::string& scene, const std::string& device, const std::string& motion,
               const std::string& grip) {
  RigOptions options;
  options.scene = file(scene), options.motion = motion;
  if (!device.empty())
    options.device = sim::simulated(scene::load_device_file(file(device)).description);
  if (!grip.empty())
    options.hand = *hand::grip(grip);
  return options;
}

std::vector<Row> run(LoopRig& rig, double seconds, Eigen::Index axis) {
  std::vector<Row> rows;
  const auto samples = static_cast<std::size_t>(seconds * rig.device().description().rate_hz);
  for (std::size_t n = 0; n < samples; ++n) {
    const Wrench& given = rig.step();
    rows.push_back({rig.device().plant().pose().position[axis], given.force.norm(),
                    given.force[axis], rig.front().out().injected_n});
  }
  return rows;
}

/// From `from_s` on.
Swing swing(const std::vector<Row>& rows, double rate_hz, double from_s) {
  Swing out;
  double low_m = 1e9, high_m = -1e9, low_n = 1e9, high_n = -1e9;
  for (auto n = static_cast<std::size_t>(from_s * rate_hz); n < rows.size(); ++n) {
    low_m = std::min(low_m, rows[n].position_m), high_m = std::max(high_m, rows[n].position_m);
    low_n = std::min(low_n, rows[n].along_n), high_n = std::max(high_n, rows[n].along_n);
    out.largest_n = std::max(out.largest_n, rows[n].force_n);
  }
  out.position_m = high_m - low_m, out.force_n = high_n - low_n;
  return out;
}

void print(const char* name, const Swing& whole, const Swing& late) {
  std::printf("%s: at most %.2f N; in the last part %.3f mm and %.3f N from peak to peak\n", name,
              whole.largest_n, 1e3 * late.position_m, late.force_n);
}

/// At rest is within three steps of the encoder, or within 0.5 % of the device's force.
void expect_rest(const Swing& late, const LoopRig& rig) {
  const DeviceDescription& d = rig.device_description();
  EXPECT_LE(late.position_m, 3.0 * d.position_resolution_m);
  EXPECT_LE(late.force_n, std::max(0.05, 0.005 * d.max_force_n));
}

/// A touch of 20 mm/s and 0.55 mm. The hand wants on until 0.4 s after it has arrived, and rests
/// then.
TEST(Swings, GentleTouchOfAnArmRests) {
  LoopRig rig(ask("floor.yaml", "arm_with_torque.yaml", "gentle", "arm"));
  const std::vector<Row> rows = run(rig, 6.0, 2);
  const double rate = rig.device_description().rate_hz;
  const Swing whole = swing(rows, rate, 0.0), late = swing(rows, rate, 4.5);
  print("gentle touch", whole, late);
  expect_rest(late, rig);
  EXPECT_LE(whole.largest_n, 1.5);
}

TEST(Swings, TouchOnACoarseEncoderRests) {
  LoopRig rig(ask("floor.yaml", "arm_coarse_encoder.yaml", "touch", "arm"));
  const std::vector<Row> rows = run(rig, 8.0, 2);
  const Swing whole = swing(rows, 1000.0, 0.0), late = swing(rows, 1000.0, 6.0);
  print("coarse encoder", whole, late);
  expect_rest(late, rig);
  EXPECT_LE(whole.largest_n, 3.0);
}

TEST(Swings, ImpactRestsWithinASecond) {
  LoopRig rig(ask("floor_blow.yaml", "slewing_arm.yaml", "blow", "pen-firm"));
  const std::vector<Row> rows = run(rig, 4.0, 2);
  const Swing whole = swing(rows, 1000.0, 0.0), late = swing(rows, 1000.0, 3.0);
  print("blow", whole, late);
  expect_rest(late, rig);
  EXPECT_EQ(rig.guard().counts().clamped_slew, 0U);
}

TEST(Swings, PegInASlotRestsWithinTwoSeconds) {
  RigOptions options = ask("slot.yaml", "slot_arm.yaml", "aside", "arm");
  options.hand->release_time_s = 6.0;
  LoopRig rig(options);
  const std::vector<Row> rows = run(rig, 12.0, 2);
  const Swing late = swing(rows, 2000.0, 8.0);
  print("slot", swing(rows, 2000.0, 0.0), late);
  expect_rest(late, rig);
}

/// Device, walls and where the hand lets go, of runs of `stability_families`.
struct Slot {
  const char* name;
  double mass_kg, damping, resolution_m, rate_hz, delay_s, lag_s, max_force_n;
  const char* grip;
  const char* kind;
  double gap_m;
};

class ReleasedInASlot : public ::testing::TestWithParam<Slot> {};

/// Without dry friction nothing but the coupling ends a bounce from wall to wall.
TEST_P(ReleasedInASlot, BouncesByLessThanPerceptible) {
  const Slot& slot = GetParam();
  WallLoopOptions o;
  DeviceDescription& d = o.designed_for;
  d.model = slot.name, d.grip = slot.grip, d.rate_hz = slot.rate_hz, d.simulated = true;
  d.mass_min_kg = slot.mass_kg, d.mass_max_kg = 1.2 * slot.mass_kg;
  d.damping_ns_per_m = slot.damping, d.coulomb_friction_n = 0.0;
  d.position_resolution_m = slot.resolution_m, d.delay_s = slot.delay_s;
  d.force_bandwidth_hz = slot.lag_s > 0.0 ? 1.0 / (2.0 * std::numbers::pi * slot.lag_s)
                                          : std::numeric_limits<double>::infinity();
  d.max_force_n = slot.max_force_n, d.max_stiffness_n_per_m = 8000.0, d.jitter = 0.2;
  derive_slew_limits(d);
  o.kind = slot.kind;
  const coupling::design::Design design = design_for(d, o.kind);
  ASSERT_NE(design.status, coupling::design::DesignStatus::kInfeasible);
  const double promise = design.translation.displayed_stiffness;
  o.device = sim::simulated(d);
  o.device.mass_kg = Vec3::Constant(1.1 * slot.mass_kg);
  o.hand = *hand::grip(slot.grip);
  o.hand.release_time_s = 1.7;
  const double depth_m = std::min(1e-3, 0.4 * d.max_force_n / promise);
  o.motion.hold_s = 0.3, o.motion.speed_m_per_s = 0.05;
  o.motion.path = {Vec3::Zero(), Vec3(0, 0, depth_m + std::max(0.0, slot.gap_m))};
  o.walls = {{.normal = Vec3::UnitZ(), .at_m = -0.5 * slot.gap_m, .n_per_m = 10.0 * promise},
             {.normal = -Vec3::UnitZ(), .at_m = -0.5 * slot.gap_m, .n_per_m = 10.0 * promise}};
  WallLoop loop(o, design);
  double low_n = 1e9, high_n = -1e9;
  for (int n = 0; n < static_cast<int>(30.0 * slot.rate_hz); ++n) {
    const double force = loop.step().force.z();
    if (n > static_cast<int>(20.0 * slot.rate_hz))
      low_n = std::min(low_n, force), high_n = std::max(high_n, force);
  }
  std::printf("%s: %.0f N/m, %.3f N from peak to peak\n", slot.name, promise, high_n - low_n);
  EXPECT_LT(high_n - low_n, 0.2);
}

INSTANTIATE_TEST_SUITE_P(Devices, ReleasedInASlot,
                         ::testing::Values(Slot{"tight_direct", 1.44, 0.129, 5.35e-6, 1835, 3.7e-3,
                                                2.4e-3, 80, "arm", "direct", -4e-4},
                                           Slot{"tight_filter", 0.069, 0.008, 7.3e-5, 1165, 5e-4,
                                                2.3e-3, 20, "pen", "shaping_filter", -4e-4},
                                           Slot{"clear_direct", 0.85, 0.077, 6.2e-5, 550, 4.9e-3,
                                                1.9e-3, 80, "arm", "direct", 1e-3},
                                           Slot{"clear_filter", 0.375, 0.06, 6.9e-5, 951, 1.7e-4, 0,
                                                25, "pen", "shaping_filter", 1.5e-3},
                                           Slot{"clear_fine", 0.878, 1.75, 9.9e-6, 1205, 8.5e-4, 0,
                                                90, "arm", "shaping_filter", 5e-5}),
                         [](const auto& one) { return std::string(one.param.name); });

/// No step of the command that the contact's wrench does not make.
TEST(Swings, InjectedDampingDoesNotFlipInASlideWithFriction) {
  RigOptions options = ask("slide_friction.yaml", "", "slide", "");
  options.device = sim::sim_lwr();
  LoopRig rig(options);
  std::vector<double> steps;
  Vec3 last_n = Vec3::Zero(), last_contact_n = Vec3::Zero();
  for (int n = 0; n < 4000; ++n) {
    const Vec3 given = rig.step().force, contact = rig.front().frame().wrench.force;
    if (n > 1 && !last_contact_n.isZero(0.0) && !contact.isZero(0.0))
      steps.push_back(
          std::max(0.0, std::abs(given.x() - last_n.x()) - (contact - last_contact_n).norm()));
    last_n = given, last_contact_n = contact;
  }
  std::sort(steps.begin(), steps.end());
  const double at_95 = steps[steps.size() * 95 / 100];
  std::printf("slide with friction: steps along of %.3f N at 95 %%, %.3f N at most\n", at_95,
              steps.back());
  EXPECT_LE(at_95, 0.05);
}

/// The rendering does not answer for a while, as when its process is suspended: the device
/// continues.
TEST(Swings, AfterADropoutTheForceComesBack) {
  for (const int stopped : {50, 100, 150}) {
    RigOptions options = ask("dropout.yaml", "", "press", "");
    options.device = sim::sim_phantom();
    LoopRig rig(options);
    for (int n = 0; n < 3000; ++n)
      rig.step();
    const double before = rig.step().force.norm();
    for (int n = 0; n < stopped; ++n)
      rig.read(), rig.finish();
    double after = 0.0;
    for (int n = 0; n < 3000; ++n)
      after = rig.step().force.norm();
    std::printf("dropout of %d ms: %.2f N before, %.2f N after\n", stopped, before, after);
    EXPECT_NEAR(after, before, 0.03 * before);
  }
}

}  // namespace
}  // namespace voxtouch::long_runs
