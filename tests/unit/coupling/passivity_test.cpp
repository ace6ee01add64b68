#include "core/coupling/passivity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "tests/unit/coupling/haptic_loop.hpp"

namespace voxtouch::coupling {
namespace passivity_test {

constexpr double kT = 1e-3;

CouplingSpec spec_with(const char* kind, double cutoff_hz) {
  CouplingSpec spec;
  spec.kind = kind, spec.cutoff_hz = cutoff_hz;
  return spec;
}

LoopDevice phantom(double push_n = 1.0, double resolution_m = 3e-5) {
  LoopDevice d;
  d.mass_kg = 0.075, d.damping_ns_per_m = 0.05, d.resolution_m = resolution_m,
  d.push = Vec3(-push_n, 0, 0);
  return d;
}
TEST(Passivity, CountsTheWorkOfAHeldForceExactly) {
  RunningCoupling coupling(spec_with("shaping_filter", 40), {}, kT);
  LoopDevice device = phantom(1.0, 0.0);
  device.hand_damping_ns_per_m = 2;
  HapticLoop loop(device, coupling, [](const Vec3& at) { return wall(at, 500); });
  loop.position = Vec3(0.002, 0, 0);
  double before = 0;
  for (int n = 0; n < 3000; ++n) {
    loop.step();
    ASSERT_NEAR(coupling.energy().translation_j(), before, 1e-12) << "of all but the last period";
    before = loop.work_in_j;
  }
  EXPECT_GT(std::abs(before), 1e-5);
}

TEST(Passivity, CountsTheWorkOfATorque) {
  RunningCoupling coupling(spec_with("direct", 1), {}, kT);
  coupling.step({}, kT);
  CouplingInput in{{{0, 0, 0}, {0.3, 0, 0}}, 100};
  for (int n = 0; n < 400; ++n) {  // free for a start: nothing is booked before a torque was given
    in.tool.orientation = Quat(Eigen::AngleAxisd(-1e-3 * n, Vec3::UnitX()));
    if (n % 3 == 0)
      in.tool.orientation.coeffs() *= -1.0;
    coupling.step(in, kT);
  }
  EXPECT_NEAR(coupling.energy().rotation_j, 0.3 * 0.399, 1e-9);
  EXPECT_EQ(coupling.energy().translation_j(), 0.0);
}

/// Once around a frictionless cylinder at a constant depth, with 2 N at 20 mm: no energy is lost or
/// gained.
TEST(Passivity, LosslessCircleIsNotBraked) {
  const double radius = 0.02, k = 1000, depth = 0.002;
  RunningCoupling coupling(spec_with("direct", 1), {}, kT);
  Vec3 axes = Vec3::Zero(), lowest = Vec3::Zero(), before = Vec3::Zero(), last = Vec3::Zero();
  for (int n = 0; n < 3000; ++n) {
    // In along x, then round at 0.1 m/s or so.
    const double in = std::min(n / 200.0, 1.0),
                 angle = n < 200 ? 0.0 : 2 * std::numbers::pi * (n - 200) / 1400.0;
    const Vec3 at =
        (radius + 0.001 - in * (depth + 0.001)) * Vec3(std::cos(angle), std::sin(angle), 0);
    axes -= last.cwiseProduct(at - before);
    if (n == 200)
      axes.setZero();  // the accounts in world axes
    lowest = lowest.cwiseMin(axes);
    CouplingInput input = cylinder(at, radius, k);
    input.tool.position = at;
    const CouplingOutput out = coupling.step(input, kT);
    last = out.wrench.force, before = at;
    EXPECT_LE((last - input.contact.force).norm(), 1e-12) << n;
  }
  EXPECT_GE(coupling.counters().lowest_energy_j, -1e-12);
  // F R/2 = 18 mJ at the 18 mm of the tool's circle.
  EXPECT_NEAR(lowest.minCoeff(), -0.018, 2e-4);
  EXPECT_NEAR(coupling.energy().tangential_j, 0.0, 1e-12);
  std::printf("lowest world axis %.2f mJ, lowest account along the contact %.3g mJ\n",
              1e3 * lowest.minCoeff(), 1e3 * coupling.counters().lowest_energy_j);
}

/// Inside a cylinder the filter's lag tau gives a force along the motion of F tau v / R: active,
/// and across the contact.
TEST(Passivity, FindsTheEnergyOfFilterDelayOnAHollow) {
  const double radius = 0.02, speed = 0.1, force = 3, k = 1000;
  {
    CouplingSpec spec = spec_with("shaping_filter", 30);
    RunningCoupling coupling(spec, {}, kT);
    double begin = 0, given = 0;
    for (int n = 0; n < 4000; ++n) {
      const double depth = force / k * std::min(n / 500.0, 1.0) - 1e-6,
                   angle = speed * kT * n / radius;
      const Vec3 at = (radius + depth) * Vec3(std::cos(angle), std::sin(angle), 0);
      CouplingInput input = cylinder(at, radius, k, true);
      input.tool.position = at;
      coupling.step(input, kT);
      if (n == 2000)
        begin = coupling.energy().tangential_j;
    }
    given = (begin - coupling.energy().tangential_j) / (2000 * kT);
    const double expected = force * lag_s(spec) * speed * speed / radius;
    EXPECT_NEAR(given, expected, 0.25 * expected);
    // 4.5 mJ of the press, less F v^2 T / (2 R) per second: energy from a constant force on a
    // concave path.
    EXPECT_NEAR(coupling.energy().normal_j, 0.0045 - 3.5 * 0.00075, 1e-3)
        << "credit along the contact, which would hide it";
  }
}

TEST(Passivity, ForgetsCreditAsTheContactEndsAndDebtASecondLater) {
  for (const double sign : {1.0, -1.0}) {
    Passivity p;
    p.command({{1, 0, 0}, {0, 0, 0}}, {1, 0, 0});
    p.observe({true, {-1e-3 * sign, 0, 0}, {0, 0, 0}}, true, kT);
    EXPECT_NEAR(p.energy().normal_j, sign * 1e-3, 1e-15);
    p.command({});
    for (int n = 1; n <= 1100; ++n) {
      p.observe({}, false, kT);
      const bool there = sign > 0 ? n * kT < kContactEndS - 1e-9 : n * kT < kDebtS - 1e-9;
      if (n != 5 && n != 1000) {
        ASSERT_EQ(p.energy().normal_j != 0.0, there) << n;
      }
    }
  }
  // The filter's tail still belongs to the contact.
  Passivity p;
  p.command({{1, 0, 0}, {0, 0, 0}}, {1, 0, 0});
  p.observe({true, {-1e-3, 0, 0}, {0, 0, 0}}, true, kT);
  p.command({{0.1, 0, 0}, {0, 0, 0}});
  for (int n = 0; n < 100; ++n)
    p.observe({}, false, kT);
  EXPECT_NEAR(p.energy().normal_j, 1e-3, 1e-15);
}

/// An encoder hides part of the path: |E - true| <= q/2 times all changes of the force.
TEST(Passivity, MatchesTheTrueEnergyUpToTheEncoder) {
  for (const double q : {1e-5, 1e-4}) {
    RunningCoupling coupling(spec_with("shaping_filter", 50), {8.5, 0}, kT);
    HapticLoop loop(phantom(0.5, q), coupling, [](const Vec3& at) { return wall(at, 300); });
    loop.position = Vec3(1e-3, 0, 0);
    double changes = 0, before = 0, last = 0;
    for (int n = 0; n < 300; ++n) {
      const double force = loop.step().wrench.force.x();
      EXPECT_LE(std::abs(coupling.energy().translation_j() - before),
                0.5 * q * (changes + last) + 1e-12)
          << n;
      changes += std::abs(force - last);
      last = force, before = loop.work_in_j;
    }
  }
}

}  // namespace passivity_test
}  // namespace voxtouch::coupling
