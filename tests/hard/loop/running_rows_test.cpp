/// The hard cases of a running coupling, one test each, through the complete path.
#include <gtest/gtest.h>
#include <time.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>

#include "tests/unit/coupling/haptic_loop.hpp"

namespace voxtouch::test {
namespace {

constexpr double kT = 1e-3;
const double kNan = std::numeric_limits<double>::quiet_NaN(),
             kInf = std::numeric_limits<double>::infinity();

coupling::CouplingSpec filter(double hz, double d, double gain = 1.0) {
  coupling::CouplingSpec spec;
  spec.cutoff_hz = hz, spec.damping_ratio = d, spec.gain = gain;
  return spec;
}
coupling::CouplingInput push(double x, double k = 1000) { return {{{x, 0, 0}, {0, 0, 0}}, k}; }

double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// H1
TEST(HardCases, AnyCutoffAndDampingRatioStaysBoundedOrIsRefused) {
  for (const double angle : {1e-9, 1e-6, 1e-3, 0.1, 1.0, 3.14, 3.15, 10.0, 1e6})
    for (const double d : {1e-9, 1e-3, 0.577, 1.0, 1e3, 1e6})
      for (const double gain : {0.0, 1.0, 3.0}) {
        const coupling::CouplingSpec spec = filter(angle / (2 * std::numbers::pi * kT), d, gain);
        if (angle >= std::numbers::pi) {
          EXPECT_THROW(coupling::RunningCoupling(spec, {}, kT), std::invalid_argument) << angle;
          continue;
        }
        coupling::RunningCoupling coupling(spec, {}, kT, 0.0);
        double peak = 0;
        for (int n = 0; n < 2000; ++n)
          peak = std::max(peak, coupling.step(push(1), kT).wrench.force.norm());
        ASSERT_TRUE(std::isfinite(peak));
        EXPECT_LE(peak, 2 * gain * (1 + 1e-9)) << angle << " " << d;
      }
  for (const double bad : {-1.0, kNan, kInf})
    EXPECT_THROW(coupling::RunningCoupling(filter(5, 1, bad), {}, kT), std::invalid_argument);
  for (const double bad : {0.0, -1.0, kNan, kInf}) {
    EXPECT_THROW(coupling::RunningCoupling(filter(bad, 1), {}, kT), std::invalid_argument);
    EXPECT_THROW(coupling::RunningCoupling(filter(5, bad), {}, kT), std::invalid_argument);
  }
}

/// Largest error of a constant contact after `steps` samples.
double steady_error(std::int64_t steps) {
  coupling::ShapingFilter law(filter(5, 1, 0.75), kT);
  double worst = 0;
  for (std::int64_t n = 0; n < steps; ++n) {
    const double error = std::abs(law.step({push(1).contact}).force.x() - 0.75);
    if (n > 3000)
      worst = std::max(worst, error);
  }
  return worst;
}

// H2
TEST(HardCases, SteadyErrorDoesNotGrowOverTenMillionSteps) {
  EXPECT_LT(steady_error(10'000'000), 1e-14 * 0.75);
}

// H3
TEST(HardCases, ReleasedForceIsZeroAndStepCostNormal) {
  coupling::CouplingSpec spec = filter(5, 1);
  spec.injected_damping_ns_per_m = 5;
  coupling::RunningCoupling coupling(spec, {}, kT);
  coupling::CouplingInput in = push(3);
  const auto time_of = [&](bool contact) {  // the best of several: other processes run too
    double best = 1e9;
    for (int run = 0; run < 5; ++run) {
      const double begin = thread_seconds();
      for (int n = 0; n < 20'000; ++n) {
        in.tool.position.x() = 1e-4 * (n % 5);
        coupling.step(contact ? in : coupling::CouplingInput{}, kT);
      }
      best = std::min(best, thread_seconds() - begin);
    }
    return best;
  };
  const double busy = time_of(true);
  coupling::CouplingOutput out;
  for (int n = 0; n < 60'000; ++n)
    out = coupling.step({}, kT);
  EXPECT_TRUE(out.wrench.zero());
  EXPECT_LT(time_of(false), 2 * busy);
}

// H4
TEST(HardCases, JitteredPeriodsAtMostDoubleTheForce) {
  std::mt19937_64 random(41);
  std::uniform_real_distribution<double> u(0, 1);
  const double bad[] = {0.0, -1e-3, -10.0, kNan, kInf, -kInf, 10.0, 1e-9, 0.02, 7e-3};
  for (const double hz : {5.0, 50.0, 400.0})
    for (const double d : {0.577, 1.0, 3.0}) {
      coupling::CouplingSpec spec = filter(hz, d);
      spec.stiffness_cap_n_per_m = 700;
      coupling::RunningCoupling coupling(spec, {}, kT);
      double peak = 0;
      for (int n = 0; n < 20'000; ++n) {
        const double dt = u(random) < 0.2 ? bad[static_cast<std::size_t>(10 * u(random))]
                                          : kT * (0.2 + 4.8 * u(random));
        const coupling::CouplingOutput out = coupling.step(push(2 * u(random) - 1, 500), dt);
        ASSERT_TRUE(out.wrench.finite());
        peak = std::max(peak, out.wrench.force.norm());
      }
      EXPECT_LE(peak, 2.0);
      EXPECT_GT(coupling.counters().faults, 2000U);
    }
}

// H5
TEST(HardCases, PeaksDecayWithinSixFilterTimes) {
  for (const char* kind : {"shaping_filter", "spring_damper", "direct"}) {
    coupling::CouplingSpec spec = filter(5, 1);
    spec.kind = kind, spec.injected_damping_ns_per_m = 5;
    coupling::RunningCoupling coupling(spec, {3.3, 0.1}, kT);
    coupling.step({}, kT);
    for (int n = 0; n < 300; ++n)
      ASSERT_LE(coupling.step(push(330), kT).wrench.force.norm(), 3.3);
    coupling::CouplingOutput out;
    for (int n = 0; n * kT < 6 / coupling::cutoff_rad_per_s(spec); ++n)
      out = coupling.step({}, kT);
    EXPECT_LT(out.wrench.force.norm(), 0.05 * 3.3) << kind;
    EXPECT_EQ(coupling.counters().clamped, 300U) << kind;
  }
}

// H6 (changes of parameters: RunningCoupling.RedesignsWhileInContactWithoutAJump)
TEST(HardCases, StartOrResetInContactBeginsAtTheHeldForce) {
  for (const char* kind : {"shaping_filter", "spring_damper", "direct"}) {
    coupling::CouplingSpec spec = filter(100, 0.7);
    spec.kind = kind, spec.injected_damping_ns_per_m = 5;
    coupling::RunningCoupling coupling(spec, {10, 1}, kT);
    double before = 0;
    const auto follow = [&](double to) {
      for (int n = 0; n < 400; ++n) {
        const double now = coupling.step(push(to, 500), kT).wrench.force.x();
        ASSERT_LE(std::abs(now - before), 1.5 * 5 * kT / coupling::kDefaultRampS) << kind << n;
        before = now;
      }
    };
    follow(4);
    EXPECT_GT(before, 1.9);
    coupling.reset({{3, 0, 0}, {0, 0, 0}});
    before = 3;
    follow(5);
    coupling.reset({{kNan, 0, 0}, {0, 0, 0}});
    EXPECT_LT(coupling.step(push(5), kT).wrench.force.norm(), 0.04);
  }
}

// L1
TEST(HardCases, RampedStiffnessStepAddsNoExtraEnergy) {
  coupling::CouplingSpec spec = filter(50, 0.707);
  spec.stiffness_cap_n_per_m = 400;
  coupling::RunningCoupling coupling(spec, {20, 0}, kT);
  coupling::LoopDevice device;
  device.mass_kg = 0.15, device.damping_ns_per_m = 0.05, device.push = Vec3(-2, 0, 0),
  device.hand_damping_ns_per_m = 12;
  coupling::HapticLoop loop(device, coupling,
                            [](const Vec3& at) { return coupling::wall(at, 2000); });
  loop.position = Vec3(0.001, 0, 0);
  for (int n = 0; n < 2000; ++n)
    loop.step();
  EXPECT_NEAR(loop.position.x(), -2.0 / 400, 1e-5);
  double before = loop.step().wrench.force.x(), steepest = 0;
  spec.stiffness_cap_n_per_m = 800;
  ASSERT_TRUE(coupling.redesign(spec));
  const double credit = coupling.energy().normal_j;
  double lowest = credit;
  for (int n = 0; n < 2000; ++n) {
    const double now = loop.step().wrench.force.x();
    lowest = std::min(lowest, coupling.energy().normal_j);
    steepest = std::max(steepest, std::abs(now - before));
    before = now;
  }
  EXPECT_NEAR(loop.position.x(), -2.0 / 800, 1e-5);
  EXPECT_LE(steepest, 0.08) << "2 N more over 200 ms, and what the tool swings";
  // A hand that presses with 2 N is moved back by 2.5 mm for any ramp: 5 mJ. A step would add dk
  // p^2/2, another 5 mJ.
  EXPECT_NEAR(credit - lowest, 0.005, 0.2 * 0.005);
}

// L2
TEST(HardCases, DryFrictionLeavesNoLimitCycle) {
  const double q = 3e-5, k = 300;
  for (const double friction : {0.5 * k * q, k * q}) {
    coupling::RunningCoupling coupling(filter(100, 0.707), {8.5, 0}, kT);
    coupling::LoopDevice device;
    device.mass_kg = 0.15, device.damping_ns_per_m = 0.05, device.push = Vec3(-1, 0, 0),
    device.hand_damping_ns_per_m = 3;
    device.friction_n = friction, device.resolution_m = q;
    coupling::HapticLoop loop(device, coupling,
                              [k](const Vec3& at) { return coupling::wall(at, k); });
    loop.position = Vec3(0.001, 0, 0);
    double low = 1, high = -1;
    for (int n = 0; n < 8000; ++n) {
      loop.step();
      if (n > 6000)
        low = std::min(low, loop.position.x()), high = std::max(high, loop.position.x());
    }
    EXPECT_LE(high - low, 0.02 * q) << friction;
  }
}

// L7
TEST(HardCases, SaturationDecaysAndKeepsTheDirection) {
  coupling::CouplingSpec spec = filter(100, 0.707);
  spec.injected_damping_ns_per_m = 2;
  coupling::RunningCoupling coupling(spec, {3.3, 0}, kT);
  coupling::LoopDevice device;
  device.mass_kg = 0.15, device.damping_ns_per_m = 0.05, device.hand_damping_ns_per_m = 3;
  device.push = 0.6 * 3.3 * Vec3(-0.8, 0.6, 0);
  const Vec3 normal(0.8, -0.6, 0);
  coupling::HapticLoop loop(device, coupling, [&](const Vec3& at) {
    const double depth = -at.dot(normal);
    if (depth < 0)
      return coupling::CouplingInput{};
    coupling::CouplingInput in;
    in.contact.force = 400 * depth * normal;
    in.contact_stiffness_n_per_m = 400;
    in.contact_stiffness.topLeftCorner<3, 3>() = 400 * normal * normal.transpose();
    return in;
  });
  loop.position = 0.002 * normal;
  loop.velocity = -0.6 * normal;
  std::uint64_t cut = 0;
  for (int n = 0; n < 4000; ++n) {
    const coupling::CouplingOutput& out = loop.step();
    ASSERT_LE(out.wrench.force.norm(), 3.3);
    ASSERT_LE(out.wrench.force.cross(normal).norm(), 1e-9);
    cut += out.clamped;
  }
  EXPECT_GT(cut, 5U) << "it did saturate";
  EXPECT_LE(loop.velocity.norm(), 1e-6);
}

}  // namespace
}  // namespace voxtouch::test
