// When an excitation ends, and that its step allocates nothing.
#include "core/identification/safety_rules.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "core/identification/device_session.hpp"
#include "core/identification/hand_check.hpp"
#include "tests/support/heap_count/heap_count.hpp"
#include "tests/support/identification/population.hpp"

namespace voxtouch::identification {
namespace {

using testing::AxisFault;
using testing::AxisTruth;

constexpr AxisLimits kLimits{.period_s = 1e-3, .allowed_force_n = 2.0};

TEST(SafetyRules, LeavingTheBoxEndsAtTheNextSample) {
  SafetyRules rules;
  rules.start(kLimits);
  EXPECT_FALSE(rules.check(0.0, 0.5, 1e-5));
  EXPECT_FALSE(rules.check(1.0, 0.5199, 1e-5));
  EXPECT_EQ(rules.check(2.0, 0.5201, 1e-5), Outcome::kLeftBounds);
}

TEST(SafetyRules, SpeedIsNotAnEncoderStep) {
  SafetyRules rules;
  rules.start(kLimits);
  for (int i = 0; i < 10; ++i)
    EXPECT_FALSE(rules.check(1e-3 * i, i % 2 == 0 ? 0.0 : 1e-4, 1e-4));
  std::optional<Outcome> broken;
  for (int i = 0; i < 10 && !broken; ++i)
    broken = rules.check(0.01 + 1e-3 * i, 1e-3 * i, 1e-4);
  EXPECT_EQ(broken, Outcome::kLeftBounds);  // 1 m/s
}

TEST(SafetyRules, ThirdInvalidSampleEnds) {
  SafetyRules rules;
  rules.start(kLimits);
  EXPECT_FALSE(rules.check(0.001, 0.0, 0.0));
  EXPECT_FALSE(rules.check(0.001, 0.0, 0.0));
  EXPECT_FALSE(rules.check(0.002, std::numeric_limits<double>::quiet_NaN(), 0.0));
  EXPECT_EQ(rules.check(0.001, 0.0, 0.0), Outcome::kInvalidSamples);
}

TEST(SafetyRules, StuckEncoderEndsAfterThreeMillimetres) {
  SafetyRules rules;
  rules.start(kLimits);
  rules.check(0.0, 0.0, 1e-5);
  rules.restart_reference(0.0);
  std::optional<Outcome> broken;
  double reference = 0.0;
  while (!broken && reference < 5e-3)
    broken = rules.check_reference(reference += 1e-4, 0.0, 1e-5);
  EXPECT_EQ(broken, Outcome::kEncoderStuck);
  EXPECT_NEAR(reference, 3.1e-3, 1.5e-4);
}

TEST(SafetyRules, ForceFollowsTheMass) {
  const AxisModel light{.mass_kg = 0.03, .coulomb_n = 0.1, .bias_n = -0.05, .delay_s = 1e-3};
  EXPECT_NEAR(force_that_mass_takes(light, 1e-3), 0.15 + 0.03 * 0.25 / 5.4e-3, 1e-9);
}

TEST(HandCheck, ReportsAnEncoderThatCountsBackwards) {
  HandCheck check;
  check.sample({0.0, 0.0, 0.0});
  check.sample({-0.021, 0.0, 0.0});
  EXPECT_EQ(check.state(), HandCheck::State::kWrongDirection);
}

TEST(HandCheck, PassesAfterBothDirectionsOfEachAxis) {
  HandCheck check;
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    for (const double x : {0.0, 0.021, -0.021}) {
      Vec3 position = Vec3::Zero();
      position[axis] = x;
      check.sample(position);
    }
  EXPECT_EQ(check.state(), HandCheck::State::kPassed);
}

TEST(HandCheck, FrozenEncoderNeverPasses) {
  HandCheck check;
  for (int i = 0; i < 100; ++i)
    check.sample({0.1, 0.2, 0.3});
  EXPECT_EQ(check.state(), HandCheck::State::kForward);
  EXPECT_EQ(check.farthest_m(), 0.0);
}

TEST(AxisExcitation, StepAllocatesNothing) {
  const AxisTruth truth{.mass_kg = 0.2, .coulomb_n = 0.2};
  testing::IdentifiedAxis device(truth, 7);
  AxisExcitation excitation;
  excitation.start({.period_s = 1e-3, .allowed_force_n = 2.0});
  long allocations = 0;
  for (int i = 0; i < 40'000 && !excitation.finished(); ++i) {
    const testing::AxisSample s = device.next();
    double force = 0.0;
    allocations += test::heap_count_of([&] { force = excitation.step(s.time_s, s.position_m); });
    device.command(force);
    if (excitation.waiting())
      excitation.resume(fit(excitation.fit_input()).model);
  }
  EXPECT_TRUE(excitation.finished());
  EXPECT_EQ(allocations, 0);
}

TEST(EncoderIncrements, SmallIncrementsOfOtherJointsAreNoStep) {
  EncoderIncrements increments;
  for (int i = 0; i < 64; ++i)
    increments.add(i % 8 == 0 ? 1e-7 : 3e-5);
  EXPECT_EQ(increments.step_m(), 3e-5);
}

TEST(DeviceSession, StopMeansZeroForceFromTheNextSample) {
  DeviceSession session;
  session.start({.limits = kLimits});
  for (int i = 0; i < 1500; ++i)
    session.step(1e-3 * i, Vec3::Zero());
  EXPECT_NE(session.step(1.5, Vec3::Zero()), Vec3::Zero());
  session.stop();
  EXPECT_EQ(session.step(1.501, Vec3::Zero()), Vec3::Zero());
}

TEST(Faults, StopWithinTheTimeAndStayBelowTheForce) {
  std::mt19937_64 random(11);
  for (const AxisFault fault :
       {AxisFault::kWrongSign, AxisFault::kRunaway, AxisFault::kStuck, AxisFault::kClockStops,
        AxisFault::kNotFinite, AxisFault::kForceTenfold})
    for (int i = 0; i < 4; ++i) {
      const auto truth = testing::random_device(random, testing::Family::kRigid);
      const double at = std::uniform_real_distribution<double>(0.0, 8.0)(random);
      const testing::FaultRun run = testing::run_fault(truth[0], fault, at, random());
      SCOPED_TRACE(static_cast<int>(fault));
      EXPECT_FALSE(run.over_force);
      if (run.left_bounds) {
        EXPECT_LE(run.time_to_zero_s, run.time_limit_s);
      }
      EXPECT_TRUE(run.stopped || fault == AxisFault::kForceTenfold);
    }
}

}  // namespace
}  // namespace voxtouch::identification
