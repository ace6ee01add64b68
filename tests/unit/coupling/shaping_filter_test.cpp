#include "tests/unit/coupling/law_alone.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/support/heap_count/heap_count.hpp"

namespace voxtouch::coupling {
namespace {

constexpr double kT = 1e-3;
const double kNan = std::numeric_limits<double>::quiet_NaN(),
             kInf = std::numeric_limits<double>::infinity();

CouplingSpec filter_spec(double cutoff_hz, double d, double gain = 1.0) {
  CouplingSpec spec;
  spec.cutoff_hz = cutoff_hz, spec.damping_ratio = d, spec.gain = gain;
  return spec;
}
CouplingSpec spec_of(const char* kind) {
  CouplingSpec spec;
  spec.kind = kind;
  return spec;
}
CouplingInput push(const Vec3& force, const Vec3& torque = Vec3::Zero(), double k = 1000) {
  return {{force, torque}, k};
}
const CouplingInput kFree{};

/// A filter after free space, so that nothing fades in.
LawAlone running(const CouplingSpec& spec, const CouplingLimits& limits = {}) {
  LawAlone filter(spec, limits, kT);
  filter.step(kFree, kT);
  return filter;
}

TEST(ShapingFilter, FiltersEachComponentAsTheScalarFilterDoes) {
  LawAlone filter = running(filter_spec(5, 1.0, 0.5));
  std::array<coupling_models::Pt2, 6> scalar;
  for (coupling_models::Pt2& s : scalar)
    s = coupling_models::Pt2(2 * std::numbers::pi * 5, 1.0, 0.5);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(-5, 5), t(kT / 5, 5 * kT);
  for (int n = 0; n < 2000; ++n) {
    const Wrench in{{u(random), u(random), u(random)}, {u(random), u(random), u(random)}};
    const double dt = t(random);
    const Wrench out = filter.step({in, 10}, dt);
    for (int i = 0; i < 3; ++i) {
      ASSERT_EQ(out.force[i], scalar[static_cast<std::size_t>(i)].step(in.force[i], dt));
      ASSERT_EQ(out.torque[i], scalar[static_cast<std::size_t>(i + 3)].step(in.torque[i], dt));
    }
  }
  EXPECT_EQ(filter.faults(), 0U);
}

TEST(ShapingFilter, HoldsAContactTimesTheGainExactly) {
  LawAlone filter(filter_spec(5, 1.0, 0.5), {}, kT);
  Wrench out;
  for (int n = 0; n < 100'000; ++n)
    out = filter.step(push({1, -2, 3}, {0.1, 0.2, -0.3}), kT);
  EXPECT_LE((out.force - Vec3(0.5, -1, 1.5)).norm(), 1e-14);
  EXPECT_LE((out.torque - Vec3(0.05, 0.1, -0.15)).norm(), 1e-15);
}

TEST(ShapingFilter, ReplacesABadPeriodByTheNominalOneAndCountsIt) {
  for (const double bad : {0.0, -1e-3, kNan, -kInf, kT / 5.01, 5.01 * kT, 9.9 * kT, 1e-300}) {
    LawAlone a = running(filter_spec(50, 0.7)), b = a;
    for (int n = 0; n < 10; ++n) {
      a.step(push({1, 0, 0}), kT);
      b.step(push({1, 0, 0}), kT);
    }
    EXPECT_EQ(a.step(push({2, 0, 0}), bad).force, b.step(push({2, 0, 0}), kT).force) << bad;
    EXPECT_EQ(a.faults(), 1U) << bad;
    EXPECT_FALSE(a.status().ramping);
  }
  for (const double good : {kT / 5, kT / 2, kT, 5 * kT}) {
    LawAlone a = running(filter_spec(50, 0.7));
    a.step(push({1, 0, 0}), good);
    EXPECT_EQ(a.faults(), 0U) << good;
  }
}

TEST(ShapingFilter, StartsAgainAtTheHeldForceAfterAGap) {
  for (const double gap : {0.0101, 0.05, 10.0, kInf}) {
    LawAlone filter = running(filter_spec(100, 0.7));
    Wrench before;
    for (int n = 0; n < 1000; ++n)
      before = filter.step(push({2, 0, 0}), kT);
    Wrench last = before, out = filter.step(push({-8, 0, 0}), gap);
    EXPECT_EQ(filter.faults(), 1U);
    double steepest = 0;
    for (int n = 0; n < 400; ++n) {
      if (n < 190) {
        EXPECT_TRUE(filter.status().ramping) << n;
      }
      steepest = std::max(steepest, (out.force - last.force).norm());
      last = out;
      out = filter.step(push({-8, 0, 0}), kT);
    }
    EXPECT_FALSE(filter.status().ramping);
    EXPECT_LE(steepest, 1.3 * 10.0 * kT / kDefaultRampS)
        << "the 10 N of difference come over the ramp's 0.2 s";
    EXPECT_NEAR(out.force.x(), -8, 1e-3);
  }
}

TEST(ShapingFilter, HoldsTheLastInputForNan) {
  LawAlone a = running(filter_spec(20, 0.7)), b = a;
  std::uint64_t bad = 0;
  for (int n = 0; n < 500; ++n) {
    const CouplingInput good = push({std::sin(0.05 * n), 1, 2}, {0.1, 0, 0.01 * n});
    a.step(good, kT), b.step(good, kT);
    EXPECT_FALSE(a.status().repeated_input);
    for (int c = 0; c < 7; ++c) {
      for (const double value : {kNan, kInf, -kInf, 1e13}) {
        CouplingInput broken = push({9, 9, 9}, {9, 9, 9}, 1.0);
        if (c < 3)
          broken.contact.force[c] = value;
        else if (c < 6)
          broken.contact.torque[c - 3] = value;
        else
          broken.contact_stiffness_n_per_m = value;
        if (n % 100 != c)
          continue;
        const Wrench out = a.step(broken, kT), expected = b.step(good, kT);
        EXPECT_EQ(out.force, expected.force);
        EXPECT_EQ(out.torque, expected.torque);
        EXPECT_TRUE(a.status().repeated_input);
        ++bad;
      }
    }
  }
  EXPECT_EQ(a.faults(), bad);
  EXPECT_GT(bad, 100U);
  EXPECT_EQ(b.faults(), 0U);
}

TEST(ShapingFilter, ClampsForceAndTorqueAlongTheirDirections) {
  for (const double gain : {1.0, 0.25, 3.0}) {
    LawAlone filter = running(filter_spec(50, 1.0, gain), {3.3, 0.2});
    Wrench out;
    for (int n = 0; n < 3000; ++n)
      out = filter.step(push({30, -40, 0}, {0, 0, 0.01}), kT);
    EXPECT_TRUE(filter.status().clamped);
    EXPECT_LE((out.force - 3.3 * Vec3(0.6, -0.8, 0)).norm(), 1e-9);
    EXPECT_LE((out.torque - gain * Vec3(0, 0, 0.01)).norm(), 1e-12)
        << "the torque was within its limit";
    for (int n = 0; n < 3000; ++n)
      out = filter.step(push({0.1, 0, 0}, {0, 5, 0}), kT);
    EXPECT_TRUE(filter.status().clamped);
    EXPECT_LE((out.torque - Vec3(0, 0.2, 0)).norm(), 1e-9);
    filter.step(push({0.1, 0, 0}), kT);
    EXPECT_FALSE(filter.status().clamped);
  }
}

TEST(ShapingFilter, GivesNoTorqueToADeviceThatHasNone) {
  LawAlone filter = running(filter_spec(50, 1.0), {3.3, 0.0});
  for (int n = 0; n < 100; ++n)
    EXPECT_TRUE(filter.step(push({1, 0, 0}, {1, 1, 1}), kT).torque.isZero(0.0));
  EXPECT_FALSE(filter.status().clamped) << "no event: the device never gives torque";
}

/// A peak of 100 times the device's force leaves the filter as fast as the largest force the device
/// can give.
TEST(ShapingFilter, ForgetsAForcePeakWithinSixFilterTimes) {
  const double limit = 3.3, w0 = 2 * std::numbers::pi * 5;
  LawAlone filter = running(filter_spec(5, 1.0), {limit, 0.1});
  double peak = 0;
  for (int n = 0; n < 300; ++n)
    peak = std::max(peak, filter.step(push({100 * limit, 0, 0}), kT).force.norm());
  EXPECT_LE(peak, limit * (1 + 1e-12));
  Wrench out;
  for (int n = 0; n * kT < 6 / w0; ++n)
    out = filter.step(kFree, kT);
  EXPECT_LT(out.force.norm(), 0.05 * limit);
}

TEST(ShapingFilter, FadesInIfItStartsInContact) {
  LawAlone filter(filter_spec(100, 0.7), {}, kT);
  Wrench last, out;
  for (int n = 0; n < 400; ++n) {
    out = filter.step(push({4, 0, 0}), kT);
    EXPECT_LE(std::abs(out.force.x() - last.force.x()), 1.3 * 4 * kT / kDefaultRampS);
    EXPECT_EQ(filter.status().ramping, n < 199) << n;
    last = out;
  }
  EXPECT_NEAR(out.force.x(), 4, 1e-6);
  // After free space a contact begins at depth zero: a ramp would only let the tool move in.
  LawAlone hit(filter_spec(100, 0.7), {}, kT);
  for (int n = 0; n < 5; ++n)
    EXPECT_TRUE(hit.step(kFree, kT).zero());
  for (int n = 0; n < 100; ++n)
    out = hit.step(push({4, 0, 0}), kT);
  EXPECT_FALSE(hit.status().ramping);
  EXPECT_NEAR(out.force.x(), 4, 1e-3);
}

TEST(ShapingFilter, WaitsForTheFirstGoodSampleBeforeItFades) {
  LawAlone filter(filter_spec(100, 0.7), {}, kT);
  for (int n = 0; n < 300; ++n)
    EXPECT_TRUE(filter.step(push({kNan, 0, 0}), kT).zero());
  EXPECT_LT(filter.step(push({4, 0, 0}), kT).force.norm(), 0.01);
  EXPECT_TRUE(filter.status().ramping);
}

TEST(ShapingFilter, ResetGivesTheHeldForceAndFadesToTheContact) {
  for (const double gain : {1.0, 0.4}) {
    LawAlone filter = running(filter_spec(100, 0.7, gain), {10, 10});
    for (int n = 0; n < 200; ++n)
      filter.step(push({7, 0, 0}), kT);
    const Wrench start{{1, 2, -1}, {0.1, 0, 0}};
    filter.reset(start);
    Wrench out = filter.step(push({5, 0, 0}), kT);
    EXPECT_LE((out.force - start.force).norm(), 0.01);
    EXPECT_LE((out.torque - start.torque).norm(), 0.001);
    EXPECT_TRUE(filter.status().ramping);
    for (int n = 0; n < 1000; ++n)
      out = filter.step(push({5, 0, 0}), kT);
    EXPECT_NEAR(out.force.x(), 5 * gain, 1e-9);
    filter.reset({{kNan, 0, 0}, {0, 0, 0}});
    EXPECT_TRUE(filter.step(kFree, kT).zero());
    filter.reset({{1e6, 0, 0}, {0, 0, 0}});
    EXPECT_LE(filter.step(kFree, kT).force.norm(), 10.0) << "a held force over the limit is cut";
  }
}

TEST(ShapingFilter, ForgetsTheLastInputOnReset) {
  LawAlone filter = running(filter_spec(100, 0.7));
  for (int n = 0; n < 200; ++n)
    filter.step(push({7, 0, 0}), kT);
  filter.reset({});
  for (int n = 0; n < 10; ++n)
    EXPECT_TRUE(filter.step(push({kNan, 0, 0}), kT).zero()) << "not the old session's force";
  filter.step(kFree, kT);
  for (int n = 0; n < 200; ++n)
    filter.step(push({7, 0, 0}), kT);
  filter.reset({{1, 0, 0}, {0, 0, 0}});
  for (int n = 0; n < 400; ++n)
    EXPECT_LE(filter.step(push({kNan, 0, 0}), kT).force.norm(), 1.01) << "fades to nothing";
}

/// Bad periods, gaps, clock steps back and NaN inputs in any order: bounded by twice the value of a
/// contact at rest.
TEST(ShapingFilter, AnyClockAtMostDoublesTheInput) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> u(0, 1);
  const auto period = [&] {
    const double bad[] = {0.0, -1.0, kNan, kInf, -kInf, 10.0, 1e-9, 7e-3, 2e-4, 5e-3};
    return u(random) < 0.3 ? bad[static_cast<std::size_t>(u(random) * 10)]
                           : kT * (0.2 + 4.8 * u(random));
  };
  for (const double hz : {5.0, 50.0, 200.0, 499.0})
    for (const double d : {0.05, 0.577, 0.707, 1.0, 3.0})
      for (const double gain : {0.5, 1.0, 2.0}) {
        LawAlone filter(filter_spec(hz, d, gain), {}, kT);
        const bool noise = d > 0.5;  // a resonant filter multiplies a resonant input: there only a
                                     // steady contact is bounded
        double peak = 0;
        for (int n = 0; n < 4000; ++n) {
          const double x = noise ? 2 * u(random) - 1 : 1.0;
          const CouplingInput in = push({u(random) < 0.02 ? kNan : x, 0, 0});
          const Wrench out = filter.step(in, period());
          ASSERT_TRUE(out.finite());
          peak = std::max(peak, out.force.norm());
        }
        EXPECT_LE(peak, 2 * gain) << hz << " " << d << " " << gain;
        EXPECT_GT(filter.faults(), 500U);
      }
}

TEST(ShapingFilter, ParametersChangeWithoutAJump) {
  LawAlone filter = running(filter_spec(5, 1.0, 1.0), {10, 1});
  Wrench last;
  for (int n = 0; n < 3000; ++n)
    last = filter.step(push({4, 0, 0}), kT);
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> u(0, 1);
  for (int n = 0; n < 3000; ++n) {
    ASSERT_TRUE(filter.set(5 + 95 * u(random), 0.5 + u(random), 2 * u(random)));
    const double gain = filter.gain();
    const Wrench out = filter.step(push({4, 0, 0}), kT);
    EXPECT_LE(std::abs(filter.gain() - gain), kGainSlewPerS * kT * (1 + 1e-12));
    EXPECT_LE(std::abs(out.force.x() - last.force.x()), 0.03) << n;
    EXPECT_LE(out.force.norm(), 10.0);
    last = out;
  }
  for (int n = 0; n < 3000; ++n)
    filter.set(50, 1, 0), filter.step(push({4, 0, 0}), kT);
  EXPECT_EQ(filter.gain(), 0.0);
  EXPECT_LE(filter.step(push({1e9, 0, 0}), kT).force.norm(), 1e-9);
  filter.set(50, 1, 1);
  EXPECT_LE(filter.step(push({1e9, 0, 0}), kT).force.norm(), 10.0)
      << "cut also on the way up from a gain of zero";
  for (const double bad : {kNan, kInf, -1.0}) {
    EXPECT_FALSE(filter.set(bad, 1, 1));
    EXPECT_FALSE(filter.set(50, bad, 1));
    EXPECT_FALSE(filter.set(50, 1, bad));
  }
  EXPECT_FALSE(filter.set(0, 1, 1));
  EXPECT_FALSE(filter.set(50, 0, 1));
}

TEST(ShapingFilter, ReleasesToExactlyZero) {
  LawAlone filter = running(filter_spec(5, 1.0));
  for (int n = 0; n < 1000; ++n)
    filter.step(push({3, 2, 1}, {0.1, 0.2, 0.3}), kT);
  Wrench out;
  for (int n = 0; n < 60'000; ++n)
    out = filter.step(kFree, kT);
  EXPECT_TRUE(out.zero());
}

TEST(Couplings, AllocateNothingInTheLoop) {
  if (!test::heap_is_counted())
    GTEST_SKIP() << "the sanitiser owns malloc";
  for (const char* kind : {"shaping_filter", "spring_damper", "direct"}) {
    LawAlone coupling(spec_of(kind), {3.3, 0.1}, kT);
    EXPECT_EQ(test::heap_count_of([&] {
                for (int n = 0; n < 2000; ++n) {
                  coupling.step(n % 7 ? push({4, 0.1 * n, 0}, {1, 0, 0}) : push({kNan, 0, 0}),
                                n % 11 ? kT : 1.0);
                  if (n % 13 == 0)
                    coupling.reset({{1, 0, 0}, {0, 0, 0}});
                  coupling.status(), coupling.faults();
                }
              }),
              0)
        << kind;
  }
}

/// The input policies are the same for all three kinds.
TEST(Couplings, CountHoldClampAndFadeAlike) {
  for (const char* kind : {"shaping_filter", "spring_damper", "direct"}) {
    LawAlone coupling(spec_of(kind), {3.3, 0.1}, kT);
    EXPECT_EQ(name_of(coupling.kind()), kind);
    EXPECT_LT(coupling.step(push({1, 0, 0}), kT).force.norm(), 0.02)
        << kind << ": starts in contact, fades in";
    EXPECT_TRUE(coupling.status().ramping);
    for (int n = 0; n < 1000; ++n)
      coupling.step(push({1, 0, 0}), kT);
    EXPECT_FALSE(coupling.status().ramping);
    const Wrench steady = coupling.step(push({1, 0, 0}), kT);
    const Wrench start = coupling.step(push({kNan, 0, 0}), kT);
    EXPECT_LE((start.force - steady.force).norm(), 1e-9) << kind;
    EXPECT_TRUE(coupling.status().repeated_input);
    EXPECT_EQ(coupling.faults(), 1U);
    const Wrench after = coupling.step(push({3, 0, 0}), 1.0);
    EXPECT_LE((after.force - steady.force).norm(), 0.05) << kind << ": a gap fades";
    EXPECT_EQ(coupling.faults(), 2U);
    for (int n = 0; n < 2000; ++n)
      coupling.step(push({50, 0, 0}), kT);
    EXPECT_TRUE(coupling.status().clamped);
    EXPECT_LE(coupling.step(push({50, 0, 0}), kT).force.norm(), 3.3 * (1 + 1e-12)) << kind;
    coupling.reset({{1, 0, 0}, {0, 0.05, 0}});
    const Wrench first = coupling.step(push({3, 0, 0}), kT);
    EXPECT_LE((first.force - Vec3(1, 0, 0)).norm(), 0.05) << kind;
    EXPECT_LE((first.torque - Vec3(0, 0.05, 0)).norm(), 0.005) << kind;
    for (int n = 0; n < 5000; ++n)
      coupling.step(kFree, kT);
    EXPECT_TRUE(coupling.step(kFree, kT).zero()) << kind;
  }
}

}  // namespace
}  // namespace voxtouch::coupling
