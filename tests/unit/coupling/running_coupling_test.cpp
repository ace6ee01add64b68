#include "core/coupling/running_coupling.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <memory>
#include <random>

namespace voxtouch::coupling {
namespace running_coupling_test {

constexpr double kT = 1e-3;
const double kNan = std::numeric_limits<double>::quiet_NaN(),
             kInf = std::numeric_limits<double>::infinity();

CouplingSpec spec_of(const char* kind) {
  CouplingSpec spec;
  spec.kind = kind, spec.cutoff_hz = 50;
  return spec;
}
/// Everything on.
CouplingSpec full(const char* kind) {
  CouplingSpec spec = spec_of(kind);
  spec.stiffness_cap_n_per_m = 800, spec.stiffness_cap_nm_per_rad = 0.5;
  spec.injected_damping_ns_per_m = 4, spec.injected_damping_nms_per_rad = 0.01;
  return spec;
}
CouplingInput push(const Vec3& force, const Vec3& torque = Vec3::Zero(), double k = 500) {
  return {{force, torque}, k};
}
constexpr const char* kKinds[] = {"shaping_filter", "spring_damper", "direct"};

/// A law's result for a sample that neither policy nor limits change.
Wrench step_alone(std::variant<DirectCoupling, ShapingFilter, SpringDamper>& law,
                  const CouplingInput& in, double dt_s) {
  if (ShapingFilter* filter = std::get_if<ShapingFilter>(&law))
    filter->advance_gain();
  return std::visit(
      [&](auto& one) {
        return one.step({in.contact, in.contact_stiffness_n_per_m, dt_s});
      },
      law);
}

/// Without cap and damping the chain is the law, bit for bit.
TEST(RunningCoupling, WithoutCapAndDampingIsTheBareLaw) {
  std::variant<DirectCoupling, ShapingFilter, SpringDamper> laws[] = {
      ShapingFilter(spec_of("shaping_filter"), kT), SpringDamper(spec_of("spring_damper")),
      DirectCoupling()};
  for (int k = 0; k < 3; ++k) {
    RunningCoupling running(spec_of(kKinds[k]), {}, kT);
    running.step({}, kT);  // begins in free space: nothing is faded in
    step_alone(laws[k], {}, kT);
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> u(-1, 1);
    for (int n = 0; n < 3000; ++n) {
      CouplingInput in =
          push({u(random), u(random), u(random)}, {u(random), 0, u(random)}, 500 + 400 * u(random));
      if (n % 5 == 0)
        in = {};
      in.contact_stiffness = 300 * Mat6::Identity();
      in.tool.position = 0.01 * Vec3(u(random), u(random), u(random));
      const double dt = n % 11 ? kT : kT * (2.6 + 2.3 * u(random));
      const CouplingOutput out = running.step(in, dt);
      const Wrench expected = step_alone(laws[k], in, dt);
      ASSERT_EQ(out.wrench.force, expected.force) << kKinds[k] << n;
      ASSERT_EQ(out.wrench.torque, expected.torque) << kKinds[k] << n;
      ASSERT_FALSE(out.ramping || out.repeated_input);
    }
    EXPECT_EQ(running.counters().faults, 0U);
    EXPECT_EQ(running.counters().samples, 3001U);
    EXPECT_EQ(name_of(running.kind()), kKinds[k]);
  }
}

TEST(RunningCoupling, RefusesWithTheSentenceOfValidate) {
  CouplingSpec bad = spec_of("direct");
  bad.injected_damping_ns_per_m = -1;
  EXPECT_THROW(RunningCoupling(bad, {}, kT), std::invalid_argument);
  EXPECT_THROW(RunningCoupling(spec_of("direct"), {}, kT, -1), std::invalid_argument);
  EXPECT_THROW(RunningCoupling(spec_of("direct"), {}, kT, 0.2, {0, 1}), std::invalid_argument);
  RunningCoupling running(spec_of("shaping_filter"), {}, kT);
  EXPECT_FALSE(running.redesign(bad));
  EXPECT_EQ(running.kind(), CouplingKind::kShapingFilter);
}

TEST(RunningCoupling, HoldsAnInvalidContactForTenPeriodsThenFades) {
  for (const char* kind : kKinds) {
    RunningCoupling running(spec_of(kind), {}, kT);
    running.step({}, kT);
    for (int n = 0; n < 500; ++n)
      running.step(push({2, 0, 0}), kT);
    const double steady = running.step(push({2, 0, 0}), kT).wrench.force.x();
    double before = steady;
    for (int n = 0; n < 500; ++n) {
      const double now = running.step(push({kNan, 0, 0}), kT).wrench.force.x();
      if (n < 9) {
        ASSERT_NEAR(now, steady, 1e-6) << kind << n;
      }
      ASSERT_LE(std::abs(now - before), 0.05) << kind << ": faded, not dropped";
      before = now;
    }
    EXPECT_NEAR(before, 0.0, 1e-6) << kind;
    for (int n = 0; n < 500; ++n) {
      const double now = running.step(push({2, 0, 0}), kT).wrench.force.x();
      ASSERT_LE(std::abs(now - before), 0.05) << kind << ": faded in again";
      before = now;
    }
    EXPECT_NEAR(before, steady, 1e-6);
  }
}

/// Pressed at rest, all parameters change at random every 7 ms, including the kind: no force step
/// above that of the ramps.
TEST(RunningCoupling, RedesignsWhileInContactWithoutAJump) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> u(0, 1);
  for (const bool kinds : {false, true}) {
    RunningCoupling running(full("shaping_filter"), {20, 1}, kT);
    CouplingInput in = push({4, 0, 0}, {0, 0.1, 0}, 1000);
    in.contact_stiffness.topLeftCorner<3, 3>() = 1000 * Mat3::Identity();
    running.step({}, kT);
    for (int n = 0; n < 1000; ++n)
      running.step(in, kT);
    double before = running.step(in, kT).wrench.force.x(), steepest = 0;
    for (int n = 0; n < 6000; ++n) {
      if (n % 7 == 0) {
        CouplingSpec next =
            full(kinds ? kKinds[static_cast<std::size_t>(3 * u(random))] : "shaping_filter");
        next.cutoff_hz = 5 + 90 * u(random), next.damping_ratio = 0.5 + u(random),
        next.gain = 2 * u(random);
        next.stiffness_n_per_m = 100 + 1e4 * u(random), next.damping_ns_per_m = 5 * u(random);
        next.stiffness_cap_n_per_m = u(random) < 0.3 ? kInf : 100 + 900 * u(random);
        next.injected_damping_ns_per_m = 20 * u(random);
        ASSERT_TRUE(running.redesign(next));
      }
      const double now = running.step(in, kT).wrench.force.x();
      steepest = std::max(steepest, std::abs(now - before));
      before = now;
    }
    // 4 N of cap over 200 ms are 20 mN per period, half-way in another direction; the filter's
    // oscillation adds the rest.
    EXPECT_LE(steepest, kinds ? 0.12 : 0.06) << kinds;
    EXPECT_GT(steepest, 0.005);
  }
}

TEST(RunningCoupling, GoesToTheNewDesignAndCountsTheOldLawsFaults) {
  RunningCoupling running(spec_of("shaping_filter"), {20, 1}, kT);
  running.step({}, kT);
  running.step(push({kNan, 0, 0}), kT);
  CouplingSpec next = spec_of("spring_damper");
  next.stiffness_n_per_m = 500;
  const CouplingInput in = push({4, 0, 0}, {0, 0, 0}, 500);
  for (int n = 0; n < 500; ++n)
    running.step(in, kT);
  const CouplingOutput before = running.step(in, kT);
  ASSERT_TRUE(running.redesign(next));
  EXPECT_NEAR(running.step(in, kT).wrench.force.x(), before.wrench.force.x(), 0.05);
  for (int n = 0; n < 500; ++n)
    running.step(in, kT);
  EXPECT_NEAR(running.step(in, kT).wrench.force.x(), 2, 1e-9);
  running.step(push({kNan, 0, 0}), kT);
  EXPECT_EQ(running.counters().faults, 2U);
  next.stiffness_n_per_m = 1500;
  ASSERT_TRUE(running.redesign(next));
  double last = 2;
  for (int n = 0; n < 1000; ++n) {
    const double now = running.step(in, kT).wrench.force.x();
    ASSERT_LE(std::abs(now - last), 0.03) << n;
    last = now;
  }
  EXPECT_NEAR(last, 3, 1e-9);
}

TEST(RunningCoupling, DampingChangesOverItsRamp) {
  CouplingSpec spec = spec_of("direct");
  RunningCoupling running(spec, {}, kT);
  running.step({}, kT);
  CouplingInput in = push({4, 0, 0}, {0, 0, 0}, 1000);
  const auto moving = [&] {
    return in.tool.position.x() -= 1e-4, running.step(in, kT).wrench.force.x();
  };
  for (int n = 0; n < 100; ++n)
    moving();
  spec.injected_damping_ns_per_m = 10;
  ASSERT_TRUE(running.redesign(spec));
  for (int n = 1; n <= 40; ++n)
    EXPECT_NEAR(moving(), 4 + std::min(n / 20.0, 1.0), 1e-6) << n;
}

/// Random bits in any field: finite and within the limits, for every kind with everything on.
/// Lowering a weight returns the energy stored by lifting it: not a fault of the coupling if it is
/// reported.
TEST(RunningCoupling, CountsNoDebtForPotentialEnergy) {
  for (const bool reported : {true, false}) {
    CouplingSpec spec = spec_of("direct");
    RunningCoupling running(spec, {}, kT, 0.001);
    double energy = 0.0;
    for (int n = 0; n < 1000; ++n) {
      CouplingInput in = push({0, 0, -1}, Vec3::Zero(), 0);
      in.tool.position.z() = -5e-5 * n;
      if (reported)
        in.supplied_energy_j = 5e-5 * n;
      energy = running.step(in, kT).energy_j;
    }
    if (reported) {
      EXPECT_NEAR(energy, 0.0, 1e-4);
    } else {
      EXPECT_NEAR(energy, -0.05, 1e-3);
    }
  }
}

TEST(RunningCoupling, AssumesAtMostTheLargestForce) {
  RunningCoupling running(spec_of("direct"), {.max_force_n = 3.0}, kT);
  CouplingInput in = push({0, 0, 1});
  running.step(in, kT);
  in.supplied_energy_j = 1e9;
  EXPECT_LT(running.step(in, kT).energy_j, 3.0 * 2.0 * kT + 1e-9);
  in.supplied_energy_j = kNan;
  EXPECT_TRUE(std::isfinite(running.step(in, kT).energy_j));
  running.reset({});
  in.supplied_energy_j = 5.0;
  EXPECT_LT(running.step(in, kT).energy_j, 1e-9) << "what was supplied before it began is not its";
}

/// Inputs of the observer's energy bound: the largest force, and the longest path under force.
TEST(RunningCoupling, TracksLargestForceAndLongestPathUnderForce) {
  RunningCoupling running(spec_of("direct"), {}, kT);
  CouplingInput in = push(Vec3::Zero(), Vec3::Zero(), 0);
  double x = 0.0;
  const auto step = [&](double displacement, double force) {
    in.tool.position.x() = x += displacement;
    in.contact.force.y() = force;
    in.contact_stiffness_n_per_m = force > 0.0 ? 500 : 0;
    running.step(in, kT);
  };
  for (int n = 0; n < 20; ++n)
    step(3e-3, 0.0);
  EXPECT_EQ(running.counters().longest_path_m, 0.0) << "nothing pushed";
  for (int n = 0; n < 300; ++n)
    step(1e-3, 2.0);  // its ramp is over
  step(2e-3, 0.5);
  for (int n = 0; n < 20; ++n)
    step(1e-4, 0.0);
  EXPECT_NEAR(running.counters().longest_path_m, 2e-3, 1e-12);
  EXPECT_NEAR(running.counters().most_force_n, 2.0, 1e-9);
  EXPECT_NEAR(energy_bound_j(2.0, 2e-3, 1e-3), 5 * 4e-3 + 2e-3, 1e-15);
}

TEST(RunningCoupling, IsFiniteAndWithinTheLimitsForAnyInput) {
  std::mt19937_64 random(77);
  const double special[] = {kNan,    -kNan, kInf,   -kInf, 0.0, -0.0,  5e-324,
                            -2e-310, 1e308, -1e308, 1e12,  1.0, -1e-3, 1e-3};
  const auto any = [&] {
    const std::uint64_t bits = random();
    switch (bits % 5) {
      case 0:
        return special[(bits >> 8) % std::size(special)];
      case 1:
        return std::bit_cast<double>(random());
      case 2:
        return static_cast<double>(static_cast<std::int64_t>(random())) * 1e-18;
      default:
        return static_cast<double>(static_cast<std::int64_t>(random())) * 1e-16;
    }
  };
  std::uint64_t samples = 0, moved = 0;
  for (const char* kind : kKinds)
    for (const CouplingLimits& limits :
         {CouplingLimits{3.3, 0.1}, CouplingLimits{8.5, 0.0}, CouplingLimits{}}) {
      CouplingSpec spec = full(kind);
      if (limits.max_force_n > 1e6) {
        spec.gain = 1e300, spec.injected_damping_ns_per_m = 1e300;
        spec.stiffness_cap_n_per_m = 1e-300;
      }
      RunningCoupling running(spec, limits, kT);
      CouplingInput in;
      for (int n = 0; n < 23'000; ++n) {
        // 50 numbers per sample; some samples keep most of the last one, so that states evolve.
        const bool all = random() % 4 == 0;
        const auto maybe = [&](double& x) {
          if (all || random() % 16 == 0)
            x = any();
        };
        for (double& x : in.contact.force)
          maybe(x);
        for (double& x : in.contact.torque)
          maybe(x);
        for (double& x : in.contact_stiffness.reshaped())
          maybe(x);
        for (double& x : in.tool.position)
          maybe(x);
        for (double& x : in.tool.orientation.coeffs())
          maybe(x);
        maybe(in.contact_stiffness_n_per_m);
        if (random() % 3 == 0)
          in = push(3 * Vec3::Random(), Vec3::Random(), 500),
          in.tool.position = 1e-3 * Vec3::Random();
        const CouplingOutput out = running.step(in, random() % 3 ? kT : any());
        ASSERT_TRUE(out.wrench.finite()) << kind << " sample " << n;
        ASSERT_LE(out.wrench.force.norm(), limits.max_force_n);
        ASSERT_LE(out.wrench.torque.norm(), limits.max_torque_nm);
        ASSERT_TRUE(std::isfinite(out.energy_j) && std::isfinite(out.energy_rotation_j));
        ASSERT_TRUE(out.scale >= 0.0 && out.scale <= 1.0);
        if (random() % 512 == 0)
          running.reset({Vec3(any(), any(), any()), Vec3(any(), any(), any())});
        ++samples, moved += !out.wrench.zero();
      }
    }
  EXPECT_GT(samples, 200'000U);  // times 50 numbers
  EXPECT_GT(moved, samples / 10);
}

/// Damping on top of a force at the limit: cut, with its direction kept.
TEST(RunningCoupling, StaysWithinTheLimitsWithDampingOnTop) {
  CouplingSpec spec = spec_of("direct");
  spec.injected_damping_ns_per_m = 50;
  RunningCoupling running(spec, {3.3, 0.1}, kT);
  running.step({}, kT);
  CouplingInput in = push({0, 3, 0}, {0, 0, 0}, 1000);
  CouplingOutput out;
  for (int n = 0; n < 100; ++n)
    in.tool.position.y() -= 5e-4, out = running.step(in, kT);
  EXPECT_TRUE(out.clamped);
  EXPECT_LE(out.wrench.force.norm(), 3.3);
  EXPECT_NEAR(out.wrench.force.y(), 3.3, 1e-12);
}

}  // namespace running_coupling_test
}  // namespace voxtouch::coupling
