#include "devices/force_guard.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "devices/limits.hpp"

namespace voxtouch::devices {
namespace force_guard_test {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kHuge = std::numeric_limits<double>::max();
constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kForever = std::numeric_limits<std::int64_t>::max();

GuardConfig quick() {  // no ramp, no slew limit: for tests of other properties
  GuardConfig config;
  config.max_force_n = 8.5;
  config.max_torque_nm = 0.5;
  config.max_force_rate_n_per_s = config.max_torque_rate_nm_per_s = kInf;
  config.start_ramp_s = config.return_ramp_s = 0.0;
  return config;
}

GuardInput push(double fx, double fy = 0.0, double fz = 0.0,
                std::int64_t valid_until_ns = kForever) {
  return {{Vec3(fx, fy, fz), Vec3::Zero()}, valid_until_ns};
}

TEST(Guard, PassesAValidCommandUnchanged) {
  ForceGuard guard(quick());
  const GuardInput in{{Vec3(1, -2, 3), Vec3(0.1, 0.2, -0.3)}, kForever};
  const Wrench out = guard.pass(in, 0);
  EXPECT_EQ(out.force, in.wrench.force);
  EXPECT_EQ(out.torque, in.wrench.torque);
  EXPECT_EQ(guard.counts().passed, 1U);
  EXPECT_EQ(guard.counts().refused() + guard.counts().clamped() + guard.counts().faded, 0U);
}

TEST(Guard, GivesZeroBeforeTheFirstCommand) {
  ForceGuard guard(quick());
  for (int i = 0; i < 10; ++i)
    EXPECT_TRUE(guard.pass(std::nullopt, i * kMs).zero());
}

TEST(Guard, RefusesNonFiniteCommandsAndHoldsTheLast) {
  for (double bad : {kNan, kInf, -kInf})
    for (int axis = 0; axis < 6; ++axis) {
      ForceGuard guard(quick());
      guard.pass(push(1.0), 0);
      GuardInput in = push(2.0);
      (axis < 3 ? in.wrench.force : in.wrench.torque)[axis % 3] = bad;
      ASSERT_EQ(guard.pass(in, kMs).force.x(), 1.0);
      ASSERT_EQ(guard.counts().refused_not_finite, 1U);
      ASSERT_EQ(guard.counts().passed, 1U);
    }
}

TEST(Guard, FadesWhenOnlyBadCommandsCome) {
  ForceGuard guard(quick());
  guard.pass(push(1.0), 0);
  Wrench out;
  for (int i = 1; i <= 23; ++i)
    out = guard.pass(push(kNan), i * kMs);
  EXPECT_TRUE(out.zero());
  EXPECT_EQ(guard.counts().refused_not_finite, 23U);
}

TEST(Guard, ClampsForceAndTorqueInTheirDirections) {
  ForceGuard guard(quick());
  const GuardInput in{{Vec3(30, -40, 0), Vec3(0, 3, 4)}, kForever};
  const Wrench out = guard.pass(in, 0);
  EXPECT_NEAR(out.force.x(), 5.1, 1e-12);
  EXPECT_NEAR(out.force.y(), -6.8, 1e-12);
  EXPECT_NEAR(out.torque.y(), 0.3, 1e-12);
  EXPECT_NEAR(out.torque.z(), 0.4, 1e-12);
  EXPECT_LE(length_of(out.force), 8.5);
  EXPECT_EQ(guard.counts().clamped_force, 1U);
  EXPECT_EQ(guard.counts().clamped_torque, 1U);
}

TEST(Guard, LeavesTorqueOutForADeviceThatGivesNone) {
  GuardConfig config = quick();
  config.max_torque_nm = config.max_torque_rate_nm_per_s = 0.0;
  ForceGuard guard(config);
  const Wrench out = guard.pass(GuardInput{{Vec3(1, 0, 0), Vec3(0, 1, 0)}, kForever}, 0);
  EXPECT_EQ(out.force.x(), 1.0);
  EXPECT_TRUE(out.torque.isZero(0.0));
  EXPECT_EQ(guard.counts().clamped(), 0U);
}

TEST(Guard, LimitsTheSlewOfForceAndTorqueAlongTheChange) {
  GuardConfig config = quick();
  config.max_force_rate_n_per_s = 1000.0;
  config.max_torque_rate_nm_per_s = 50.0;
  ForceGuard guard(config);
  const GuardInput in{{Vec3(3, 4, 0), Vec3(0, 0, -0.2)}, kForever};
  const Wrench out = guard.pass(in, 0);  // the first call counts as one period
  EXPECT_NEAR(out.force.x(), 0.6, 1e-12);
  EXPECT_NEAR(out.force.y(), 0.8, 1e-12);
  EXPECT_NEAR(out.torque.z(), -0.05, 1e-12);
  Wrench later;
  for (int i = 1; i < 5; ++i)
    later = guard.pass(in, i * kMs);
  EXPECT_NEAR(later.force.y(), 4.0, 1e-9);
  EXPECT_EQ(guard.pass(in, 5 * kMs).force, in.wrench.force);
  EXPECT_GE(guard.counts().clamped_slew, 4U);
}

TEST(Guard, HoldsThreePeriodsThenFadesWithin20Milliseconds) {
  ForceGuard guard(quick());
  guard.pass(push(2.0), 0);
  for (int i = 1; i <= 3; ++i)
    ASSERT_EQ(guard.pass(std::nullopt, i * kMs).force.x(), 2.0);
  EXPECT_EQ(guard.counts().faded, 0U);
  for (int i = 4; i < 23; ++i) {
    const double expected = 2.0 * (1.0 - (i - 3) / 20.0);
    ASSERT_NEAR(guard.pass(std::nullopt, i * kMs).force.x(), expected, 1e-12) << i;
  }
  for (int i = 23; i < 40; ++i)
    ASSERT_TRUE(guard.pass(std::nullopt, i * kMs).zero()) << i;
  EXPECT_EQ(guard.counts().faded, 1U);
}

TEST(Guard, HoldAndFadeAreSettable) {
  GuardConfig config = quick();
  config.hold_periods = 1.0;
  config.fade_s = 0.002;
  ForceGuard guard(config);
  guard.pass(push(2.0), 0);
  EXPECT_EQ(guard.pass(std::nullopt, kMs).force.x(), 2.0);
  EXPECT_NEAR(guard.pass(std::nullopt, 2 * kMs).force.x(), 1.0, 1e-12);
  EXPECT_TRUE(guard.pass(std::nullopt, 3 * kMs).zero());
}

TEST(Guard, RefusesAnExpiredCommandAndFadesAnExpiringOne) {
  ForceGuard guard(quick());
  EXPECT_TRUE(guard.pass(push(1, 0, 0, 10 * kMs - 1), 10 * kMs).zero());
  EXPECT_EQ(guard.counts().refused_stale, 1U);
  EXPECT_EQ(guard.pass(push(1, 0, 0, 11 * kMs), 11 * kMs).force.x(), 1.0);
  EXPECT_NEAR(guard.pass(std::nullopt, 12 * kMs).force.x(), 0.95,
              1e-12);  // valid-until is before three periods
}

TEST(Guard, FadesFromItsOutputUnderTheSlewLimit) {
  GuardConfig config = quick();
  config.max_force_rate_n_per_s = config.max_force_n / config.fade_s;  // the least that is allowed
  ForceGuard guard(config);
  std::int64_t now = 0;
  for (; now < 30 * kMs; now += kMs)
    guard.pass(push(-8.5), now);
  double last = guard.pass(push(8.5), now).force.x();  // has just started to reverse
  const std::int64_t received_at = now;
  for (now += kMs; now <= received_at + 23 * kMs; now += kMs) {
    const double out = guard.pass(std::nullopt, now).force.x();
    ASSERT_LE(std::abs(out - last), config.max_force_rate_n_per_s * 1e-3 * (1 + 1e-9));
    last = out;
  }
  EXPECT_EQ(last, 0.0);
}

TEST(Guard, RampsInAtTheStartAndFasterAfterAFade) {
  GuardConfig config = quick();
  config.start_ramp_s = 0.5;
  config.return_ramp_s = 0.1;
  ForceGuard guard(config);
  std::int64_t now = 0;
  EXPECT_TRUE(guard.pass(push(2.0), now).zero());
  for (int i = 1; i <= 250; ++i)
    guard.pass(push(2.0), now = i * kMs);
  EXPECT_NEAR(guard.pass(push(2.0), now = 251 * kMs).force.x(), 2.0 * 0.502, 1e-9);
  EXPECT_TRUE(guard.ramping());
  for (int i = 252; i <= 501; ++i)
    guard.pass(push(2.0), now = i * kMs);
  EXPECT_EQ(guard.pass(push(2.0), now += kMs).force.x(), 2.0);
  EXPECT_FALSE(guard.ramping());
  for (int i = 0; i < 30; ++i)
    guard.pass(std::nullopt, now += kMs);
  EXPECT_TRUE(guard.pass(push(2.0), now += kMs).zero());
  for (int i = 0; i < 50; ++i)
    guard.pass(push(2.0), now += kMs);
  EXPECT_NEAR(guard.pass(push(2.0), now += kMs).force.x(), 2.0 * 0.51, 1e-9);
}

TEST(Guard, FadeDoesNotShortenTheStartRamp) {
  GuardConfig config = quick();
  config.start_ramp_s = 0.5;
  config.return_ramp_s = 0.0;
  ForceGuard guard(config);
  guard.pass(push(2.0), 0);
  guard.pass(push(2.0), kMs);
  std::int64_t now = kMs;
  for (int i = 0; i < 30; ++i)
    guard.pass(std::nullopt, now += kMs);
  guard.pass(push(2.0), now += kMs);
  EXPECT_NEAR(guard.pass(push(2.0), now += kMs).force.x(), 2.0 * 0.002, 1e-12);
}

TEST(Guard, CommandDuringAFadeContinuesFromIt) {
  GuardConfig config = quick();
  config.return_ramp_s = 0.1;
  ForceGuard guard(config);
  guard.pass(push(2.0), 0);
  std::int64_t now = 0;
  for (int i = 1; i <= 13; ++i)
    guard.pass(std::nullopt, now = i * kMs);  // half faded
  EXPECT_NEAR(guard.fraction(), 0.5, 1e-12);
  EXPECT_NEAR(guard.pass(push(2.0), now += kMs).force.x(), 0.9,
              1e-9);  // aged one period more, then taken up
  EXPECT_NEAR(guard.pass(push(2.0), now += kMs).force.x(), 0.92, 1e-9);
}

TEST(Guard, StopGivesZeroAtOnceUntilRestart) {
  GuardConfig config = quick();
  config.max_force_rate_n_per_s = 1000.0;
  ForceGuard guard(config);
  for (int i = 0; i < 20; ++i)
    guard.pass(push(5.0), i * kMs);
  guard.stop();
  guard.stop();
  for (int i = 20; i < 40; ++i)
    ASSERT_TRUE(guard.pass(push(5.0), i * kMs).zero());
  EXPECT_TRUE(guard.stopped());
  guard.restart();
  EXPECT_NEAR(guard.pass(push(5.0), 40 * kMs).force.x(), 1.0, 1e-9);
}

TEST(Guard, StalledClockCannotHoldAForce) {
  for (std::int64_t step : {std::int64_t{0}, -kMs, -1000 * kMs}) {
    ForceGuard guard(quick());
    std::int64_t now = 5000 * kMs;
    guard.pass(push(2.0), now);
    Wrench out;
    for (int i = 0; i < 23; ++i)
      out = guard.pass(std::nullopt, now += step);
    EXPECT_TRUE(out.zero()) << step;
    EXPECT_EQ(guard.counts().clock_faults, 23U);
  }
}

TEST(Guard, ShortGapKeepsTheSlewLimit) {
  GuardConfig config = quick();
  config.max_force_rate_n_per_s = 500.0;
  ForceGuard guard(config);
  for (int i = 0; i < 30; ++i)
    guard.pass(push(8.0), i * kMs);
  const double out =
      guard.pass(push(-8.0), 39 * kMs).force.x();  // ten periods later, during a fade
  EXPECT_NEAR(out, 8.0 - 500.0 * 3e-3, 1e-9) << "no more than the hold time's worth";
}

TEST(Guard, LongGapRestartsFromZero) {
  GuardConfig config = quick();
  config.max_force_rate_n_per_s = 500.0;
  ForceGuard guard(config);
  for (int i = 0; i < 30; ++i)
    guard.pass(push(8.0), i * kMs);
  EXPECT_TRUE(guard.pass(push(-8.0), 10'000 * kMs).zero());
  EXPECT_NEAR(guard.pass(push(-8.0), 10'001 * kMs).force.x(), -0.5, 1e-9);
  EXPECT_EQ(guard.counts().faded, 1U);
}

TEST(Guard, CountsWhatTheGateRefused) {
  ForceGuard guard(quick());
  for (GateVerdict v :
       {GateVerdict::kAccepted, GateVerdict::kForeignWriter, GateVerdict::kForeignSession,
        GateVerdict::kOldSequence, GateVerdict::kFutureSequence})
    guard.count(v);
  EXPECT_EQ(guard.counts().refused_writer, 1U);
  EXPECT_EQ(guard.counts().refused_session, 1U);
  EXPECT_EQ(guard.counts().refused_sequence, 2U);
  EXPECT_EQ(guard.counts().refused(), 4U);
}

/// Any input at any time: finite, within the limits, and never faster than the slew limit.
TEST(Guard, OutputIsFiniteAndLimitedForAnyInput) {
  const std::vector<double> odd = {0.0,     -0.0, 5e-324, -5e-324, 1e-310, kHuge, -kHuge, 1e200,
                                   -1e-200, kNan, kInf,   -kInf,   1.0,    -8.5,  8.5,    20.0};
  const std::vector<std::int64_t> steps = {
      kMs, kMs, kMs, kMs, 0, 1, -kMs, 7 * kMs, 30 * kMs, 400 * kMs, -3600'000 * kMs};
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    std::mt19937_64 random(seed);
    const auto any = [&](const auto& list) { return list[random() % list.size()]; };
    GuardConfig config = quick();
    config.max_force_rate_n_per_s = 425.0, config.max_torque_rate_nm_per_s = 25.0;
    config.start_ramp_s = seed % 2 ? 0.05 : 0.0, config.return_ramp_s = seed % 3 ? 0.02 : 0.0;
    ForceGuard guard(config);
    std::int64_t now = 0;
    Wrench last;
    for (int i = 0; i < 5000; ++i) {
      const std::int64_t step = random() % 1000 ? any(steps) : static_cast<std::int64_t>(random());
      // Unsigned: the sum wraps and the difference of two far stamps still fits.
      const std::uint64_t from = static_cast<std::uint64_t>(now),
                          to = from + static_cast<std::uint64_t>(step);
      const std::int64_t next = static_cast<std::int64_t>(to);
      const double dt_s = i > 0 && next > now ? 1e-9 * static_cast<double>(to - from) : 1e-3;
      now = next;
      std::optional<GuardInput> in;
      if (random() % 4) {
        in.emplace();
        for (int axis = 0; axis < 3; ++axis)
          in->wrench.force[axis] = any(odd), in->wrench.torque[axis] = any(odd);
        in->valid_until_ns = random() % 8 ? kForever : static_cast<std::int64_t>(random());
      }
      const Wrench out = guard.pass(in, now);
      ASSERT_TRUE(out.finite()) << "seed " << seed << " step " << i;
      ASSERT_LE(length_of(out.force), 8.5) << "seed " << seed << " step " << i;
      ASSERT_LE(length_of(out.torque), 0.5) << "seed " << seed << " step " << i;
      const double most_s = dt_s * (1 + 1e-9) + 1e-12;
      ASSERT_LE((out.force - last.force).norm(), 425.0 * most_s)
          << "seed " << seed << " step " << i;
      ASSERT_LE((out.torque - last.torque).norm(), 25.0 * most_s)
          << "seed " << seed << " step " << i;
      last = out;
    }
  }
}

TEST(Guard, SurvivesExtremeTimes) {
  ForceGuard guard(quick());
  const std::int64_t low = std::numeric_limits<std::int64_t>::min(), high = kForever;
  for (std::int64_t now : {low, high, low, std::int64_t{0}, high, high, low}) {
    const Wrench out = guard.pass(push(1.0), now);
    EXPECT_TRUE(out.finite());
  }
}

std::string sentence(const GuardConfig& config) {
  try {
    ForceGuard guard(config);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(GuardConfig, NamesTheWrongField) {
  EXPECT_EQ(sentence(quick()), "");
  const auto with = [](double GuardConfig::*field, double value) {
    GuardConfig config = quick();
    config.*field = value;
    return sentence(config);
  };
  EXPECT_NE(with(&GuardConfig::max_force_n, 0.0).find("max_force_n is 0"), std::string::npos);
  for (double bad : {kNan, -1.0, kInf}) {
    EXPECT_NE(with(&GuardConfig::period_s, bad).find("period_s"), std::string::npos);
    EXPECT_NE(with(&GuardConfig::max_force_n, bad).find("max_force_n"), std::string::npos);
    EXPECT_NE(with(&GuardConfig::max_torque_nm, bad).find("max_torque_nm"), std::string::npos);
    EXPECT_NE(with(&GuardConfig::hold_periods, bad).find("hold_periods"), std::string::npos);
    EXPECT_NE(with(&GuardConfig::fade_s, bad).find("fade_s"), std::string::npos);
    EXPECT_NE(with(&GuardConfig::start_ramp_s, bad).find("start_ramp_s"), std::string::npos);
    EXPECT_NE(with(&GuardConfig::return_ramp_s, bad).find("return_ramp_s"), std::string::npos);
  }
  EXPECT_NE(with(&GuardConfig::max_force_rate_n_per_s, 100.0).find("max_force_n / fade_s = 425"),
            std::string::npos);
  EXPECT_NE(with(&GuardConfig::max_torque_rate_nm_per_s, kNan).find("max_torque_rate_nm_per_s"),
            std::string::npos);
}

}  // namespace force_guard_test
}  // namespace voxtouch::devices
