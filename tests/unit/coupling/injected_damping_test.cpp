#include "core/coupling/injected_damping.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <random>

#include "core/coupling/running_coupling.hpp"
#include "core/coupling/tool_motion.hpp"

namespace voxtouch::coupling {
namespace injected_damping_test {

constexpr double kT = 1e-3;
const double kNan = std::numeric_limits<double>::quiet_NaN();

Pose at(const Vec3& position, const Quat& orientation = Quat::Identity()) {
  return {position, orientation};
}

TEST(ToolMotion, FiltersDifferencesByItsFormula) {
  ToolMotion motion(kT, 100, {});
  const double a = std::exp(-2 * std::numbers::pi * 100 * kT);
  motion.step(at(Vec3::Zero()), kT);
  double expected = 0, before = 0;
  for (int n = 1; n < 200; ++n) {
    const double x = 1e-3 * std::sin(0.05 * n);
    expected = a * expected + (1 - a) * (x - before) / kT;
    before = x;
    const ToolStep& step = motion.step(at({x, 0, -x}), kT);
    EXPECT_TRUE(step.known);
    EXPECT_NEAR(motion.velocity().linear.x(), expected, 1e-12);
    EXPECT_NEAR(motion.velocity().linear.z(), -expected, 1e-12);
  }
}

TEST(ToolMotion, WeighsAWindowOfDifferencesByItsFormula) {
  for (int window = 1; window <= kMaxVelocityWindow; ++window) {
    double sum = 0.0, sizes = 0.0;
    for (int ago = 0; ago < window_span(window); ++ago)
      sum += window_weight(window, ago), sizes += std::abs(window_weight(window, ago));
    EXPECT_NEAR(sum, 1.0, 1e-15);
    EXPECT_NEAR(sizes, kWindowGain, 1e-15);
    ToolMotion motion(kT, 100, {}, window);
    const auto x = [](int n) { return 1e-3 * std::sin(0.05 * n); };
    for (int n = 0; n < 200; ++n) {
      motion.step(at({x(n), 0, -x(n)}, Quat(Eigen::AngleAxisd(0.2 * x(n), Vec3::UnitY()))), kT);
      if (n < window_span(window))
        continue;
      const double u = (x(n) - x(n - window)) / (window * kT),
                   w = (x(n - window) - x(n - 3 * window)) / (2 * window * kT);
      const double expected = 1.5 * u - 0.5 * w;
      EXPECT_NEAR(motion.velocity().linear.x(), expected, 1e-12) << window << " " << n;
      EXPECT_NEAR(motion.velocity().linear.z(), -expected, 1e-12);
      EXPECT_NEAR(motion.velocity().angular.y(), 0.2 * expected, 1e-9);
    }
  }
}

/// Response of v^ to one encoder step over the window; and v^ leads an acceleration by a quarter of
/// n.
TEST(ToolMotion, WindowScalesAStepAndExtrapolates) {
  constexpr double kStep = 3e-5;
  for (int window = 1; window <= kMaxVelocityWindow; ++window) {
    ToolMotion steps(kT, 100, {}, window), falls(kT, 100, {}, window);
    for (int n = 0; n < 40; ++n) {
      steps.step(at({n < 20 ? 0.0 : kStep, 0, 0}), kT);
      falls.step(at({0.5 * n * n * kT * kT, 0, 0}), kT);
      const double fraction = n < 20                ? 0.0
                              : n < 20 + window     ? 1.5
                              : n < 20 + 3 * window ? -0.25
                                                    : 0.0;
      EXPECT_NEAR(steps.velocity().linear.x(), fraction * kStep / (window * kT), 1e-12)
          << window << " " << n;
      if (n >= window_span(window)) {
        EXPECT_NEAR(falls.velocity().linear.x(), (n + 0.25 * window) * kT, 1e-12);
      }
    }
  }
}

/// With positions off by up to half a step, the error of v^ stays within the designer's noise
/// bound, and nearly reaches it for the worst pattern.
TEST(ToolMotion, EncoderNoiseStaysWithinItsBound) {
  constexpr double kStep = 3e-5;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> u(-0.5, 0.5);
  for (const auto& [hz, window] :
       {std::pair{50.0, 0}, {200.0, 0}, {100.0, 1}, {100.0, 2}, {100.0, 4}}) {
    const double fraction = window > 0 ? window_step_ratio(window)
                                       : 1 - std::exp(-2 * std::numbers::pi * hz * kT),
                 most = fraction * kStep / kT;
    ToolMotion shown(kT, hz, {}, window), real(kT, hz, {}, window);
    double worst = 0.0, x = 0.0;
    for (int n = 0; n < 20'000; ++n) {
      x += 2e-4 * u(random);
      shown.step(at({kStep * std::floor(x / kStep), 0, 0}), kT);
      real.step(at({x, 0, 0}), kT);
      if (n > 0)
        worst = std::max(worst, (shown.velocity().linear - real.velocity().linear).norm());
    }
    EXPECT_LE(worst, most * (1 + 1e-9)) << hz << " " << window;
    // Between two neighbouring positions: down against the window's weights, and up again.
    ToolMotion between(kT, hz, {}, window);
    double least = 0.0, highest = 0.0;
    for (int n = 0; n < 400; ++n) {
      const bool up = n >= 200 || (window > 0 && n <= 200 - window_span(window));
      between.step(at({up ? kStep : 0.0, 0, 0}), kT);
      least = std::min(least, between.velocity().linear.x()),
      highest = std::max(highest, between.velocity().linear.x());
    }
    EXPECT_NEAR(std::max(highest, -least), most, 1e-12);
  }
}

/// A displacement of two periods, after a lost sample, counts as two differences: the window is not
/// longer.
TEST(ToolMotion, LostSamplesDoNotLengthenTheWindow) {
  ToolMotion motion(kT, 100, {}, 2);
  for (int n = 0; n < 60; ++n) {
    const bool lost = n == 50;
    motion.step(at({lost ? kNan : 0.5 * n * n * kT * kT, 0, 0}), kT);
    if (n >= 53 && n <= 55) {  // the two lie within w
      EXPECT_NEAR(motion.velocity().linear.x(), (n + 0.5) * kT, 1e-12) << n;
    }
  }
}

TEST(ToolMotion, JumpEmptiesTheWindow) {
  for (int window = 1; window <= kMaxVelocityWindow; ++window) {
    ToolMotion motion(kT, 100, {}, window);
    for (int n = 0; n < 100; ++n)
      motion.step(at({1e-4 * n, 0, 0}), kT);
    for (int n = 0; n < 20; ++n) {
      motion.step(at({0.5, 0, 0}), kT);
      EXPECT_TRUE(motion.velocity().linear.isZero(0.0)) << window << " " << n;
    }
  }
}

TEST(ToolMotion, WindowBeginsAtRest) {
  ToolMotion motion(kT, 100, {}, 2);
  for (int n = 0; n < 20; ++n) {
    motion.step(at({1e-4 * n, 0, 0}), kT);
    EXPECT_NEAR(motion.velocity().linear.x(), 0.1 * std::min(1.0, n / 2.0), 1e-12) << n;
  }
}

/// Another window, or the filter, from the next sample on: both agree for a steady motion.
TEST(ToolMotion, WindowMayChangeDuringMotion) {
  ToolMotion motion(kT, 100, {});
  for (int n = 0; n < 300; ++n) {
    if (n >= 100 && n % 10 == 0)
      motion.set_filter(100, n / 10 % (kMaxVelocityWindow + 1));
    motion.step(at({1e-4 * n, 0, 0}), kT);
    if (n >= 100) {
      EXPECT_NEAR(motion.velocity().linear.x(), 0.1, 1e-9) << n;
    }
  }
}

TEST(ToolMotion, TakesTheShorterRotationForEitherSign) {
  const Vec3 axis = Vec3(1, -2, 2) / 3;
  for (const double rate : {0.5, -30.0}) {
    ToolMotion motion(kT, 100, {});
    for (int n = 0; n < 100; ++n) {
      Quat q(Eigen::AngleAxisd(3.0 + rate * kT * n, axis));
      if (n % 2)
        q.coeffs() *= -1.0;
      const ToolStep& step = motion.step(at(Vec3::Zero(), q), kT);
      if (n > 0) {
        EXPECT_LE((step.rotation - rate * kT * axis).norm(), 1e-12);
      }
    }
    EXPECT_LE((motion.velocity().angular - rate * axis).norm(), 1e-6 * std::abs(rate));
  }
}

/// A hand at 0.2 m/s with samples that are early, late, lost twice, or with an invalid clock.
TEST(ToolMotion, UnevenAndBrokenPeriodsMakeNoSpike) {
  for (int window = 0; window <= kMaxVelocityWindow; ++window) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> u(0, 1);
    ToolMotion motion(kT, 100, {}, window);
    double x = 0, fastest = 0;
    for (int n = 0; n < 20'000; ++n) {
      double displacement = kT * (0.2 + 9.7 * u(random) * u(random)), said = displacement;
      if (u(random) < 0.1) {
        const double bad[] = {0.0, -1.0, kNan, 1e-9, -kT};
        displacement = kT, said = bad[static_cast<std::size_t>(5 * u(random))];
      } else if (u(random) < 0.01) {
        displacement = said = 10.0;  // the loop was suspended for ten seconds
      }
      x += 0.2 * displacement;
      motion.step(at({x, 0, 0}), said);
      fastest = std::max(fastest, motion.velocity().linear.norm());
    }
    EXPECT_LE(fastest, 0.2 * (1 + 1e-9));
    EXPECT_GT(fastest, 0.19);
    EXPECT_EQ(motion.jumps(), 0U);
  }
}

TEST(ToolMotion, SampleWithoutAPoseCountsTowardsTheNext) {
  for (const Pose& bad : {at({kNan, 0, 0}), at({1e13, 0, 0}), at({0, 0, 0}, Quat(0, 0, 0, 0)),
                          at({0, 0, 0}, Quat(2, 0, 0, 0)), at({0, 0, 0}, Quat(kNan, 0, 0, 0))}) {
    for (const int window : {0, 1, 4}) {
      ToolMotion motion(kT, 100, {}, window);
      for (int n = 0; n < 100; ++n)
        motion.step(at({2e-4 * n, 0, 0}), kT);
      for (int n = 0; n < 3; ++n)
        EXPECT_FALSE(motion.step(bad, kT).known);
      EXPECT_TRUE(motion.step(at({2e-4 * 103, 0, 0}), kT).known);
      EXPECT_NEAR(motion.velocity().linear.x(), 0.2, 1e-9);
      for (int n = 0; n < 11; ++n)
        motion.step(bad, kT);
      EXPECT_TRUE(motion.velocity().linear.isZero(0.0))
          << "after ten periods it is not known any more";
    }
  }
}

TEST(ToolMotion, JumpGivesNoVelocity) {
  for (const int window : {0, 1, 4}) {
    ToolMotion motion(kT, 100, {}, window);
    for (int n = 0; n < 100; ++n)
      motion.step(at({1e-4 * n, 0, 0}), kT);
    EXPECT_FALSE(motion.step(at({0.5, 0, 0}), kT).known);
    EXPECT_TRUE(motion.velocity().linear.isZero(0.0));
    EXPECT_FALSE(motion.step(at({0.5, 0, 0}, Quat(0, 1, 0, 0)), kT).known)
        << "half a turn in a millisecond";
    EXPECT_EQ(motion.jumps(), 2U);
    EXPECT_TRUE(motion.step(at({0.5001, 0, 0}, Quat(0, 1, 0, 0)), kT).known);
    EXPECT_LT(motion.velocity().linear.x(), 0.1 + 1e-12);
  }
}

TEST(ToolMotion, RestsAtExactlyZero) {
  for (const int window : {0, 1, 4}) {
    ToolMotion motion(kT, 100, {}, window);
    for (int n = 0; n < 100; ++n)
      motion.step(at({1e-4 * n, 0, 0}), kT);
    EXPECT_GT(motion.velocity().linear.x(), 0.09);
    for (int n = 0; n < 500; ++n)
      motion.step(at({99e-4, 0, 0}), kT);
    EXPECT_TRUE(motion.velocity().linear.isZero(0.0));
  }
}

/// A contact with one or two walls at a constant depth, displayed by the direct coupling.
CouplingInput corner(const Vec3& force, double kx, double ky) {
  CouplingInput in;
  in.contact.force = force;
  in.contact_stiffness_n_per_m = kx + ky;
  in.contact_stiffness(0, 0) = kx, in.contact_stiffness(1, 1) = ky;
  return in;
}

struct Moving {
  RunningCoupling coupling;
  Pose pose;
  CouplingOutput out;

  explicit Moving(double b_linear, double b_angular = 0.0, double fraction = 0.0, double free = 0.0)
      : coupling(spec(b_linear, b_angular, fraction, free), {}, kT) {
    coupling.step({}, kT);
  }
  static CouplingSpec spec(double b_linear, double b_angular, double fraction, double free) {
    CouplingSpec s;
    s.kind = "direct", s.injected_damping_ns_per_m = b_linear,
    s.injected_damping_nms_per_rad = b_angular, s.damping_force_ratio = fraction,
    s.damping_force_offset_n = free;
    return s;
  }
  /// Long enough for v^ to be the velocity.
  const Wrench& move(CouplingInput in, const Vec3& velocity, const Vec3& turn = Vec3::Zero()) {
    for (int n = 0; n < 60; ++n) {
      pose.position += kT * velocity;
      if (turn.norm() > 0.0)
        pose.orientation =
            Quat(Eigen::AngleAxisd(kT * turn.norm(), turn.normalized())) * pose.orientation;
      in.tool = pose;
      out = coupling.step(in, kT);
    }
    return out.wrench;
  }
};

TEST(InjectedDamping, LeavesSlidingFreeAndDampsACorner) {
  Moving m(5);
  const CouplingInput plane = corner({3, 0, 0}, 1000, 0), both = corner({3, 3, 0}, 1000, 500);
  EXPECT_LE((m.move(plane, {0, 0.2, -0.1}).force - Vec3(3, 0, 0)).norm(), 1e-12);
  EXPECT_LE((m.move(plane, {0.1, 0, 0}).force - Vec3(2.5, 0, 0)).norm(), 1e-9);
  EXPECT_LE((m.move(plane, {-0.1, 0, 0}).force - Vec3(3.5, 0, 0)).norm(), 1e-9);
  EXPECT_LE((m.move(both, {-0.1, -0.1, 0.1}).force - Vec3(3.5, 3.25, 0)).norm(), 1e-9)
      << "each as its fraction is";
}

TEST(InjectedDamping, DampsRotationAboutResistingDirections) {
  Moving m(0, 0.02);
  CouplingInput in = corner({0, 0, 1}, 0, 0);
  in.contact.torque = Vec3(0.05, 0, 0);
  in.contact_stiffness(2, 2) = 800;
  in.contact_stiffness(3, 3) = 0.4, in.contact_stiffness(4, 4) = 0.1;
  EXPECT_LE((m.move(in, Vec3::Zero(), {-1, 0, 0}).torque - Vec3(0.07, 0, 0)).norm(), 1e-6);
  EXPECT_LE((m.move(in, Vec3::Zero(), {0, 2, 0}).torque - Vec3(0.05, -0.01, 0)).norm(), 1e-6);
  EXPECT_LE((m.move(in, Vec3::Zero(), {0, 0, 3}).torque - Vec3(0.05, 0, 0)).norm(), 1e-6)
      << "about the normal it spins free";
}

TEST(InjectedDamping, NeverPullsAtAnySpeed) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int attempt = 0; attempt < 200; ++attempt) {
    Moving m(50, 1);
    const Vec3 force = 2 * Vec3(u(random), u(random), u(random));
    CouplingInput in = corner(force, 1000, 200);
    in.contact.torque = 0.1 * Vec3(u(random), u(random), u(random));
    const Wrench& out = m.move(in, 0.5 * Vec3(u(random), u(random), u(random)),
                               5 * Vec3(u(random), u(random), u(random)));
    EXPECT_GE(out.force.dot(force), -1e-12);
    EXPECT_GE(out.torque.dot(in.contact.torque), -1e-12);
  }
  Moving m(50);
  EXPECT_LE(m.move(corner({1, 0, 0}, 1000, 0), {0.5, 0, 0}).force.norm(), 1e-12);
}

/// In the middle of a tight slot the forces cancel. A step of the encoder back to it must be damped
/// like the step away from it, or a released device goes to and fro for ever.
TEST(InjectedDamping, IsBoundedByItsOffsetIfOppositeWallsCancel) {
  CouplingInput middle = corner({0, 0, 0}, 1000, 0);
  middle.coherence = 0.0;
  Moving bounded(5, 0.0, 0.35, 0.05);
  EXPECT_LE((bounded.move(middle, {0.1, 0, 0}).force - Vec3(-0.05, 0, 0)).norm(), 1e-12);
  EXPECT_TRUE(bounded.out.bounded);
  EXPECT_LE((bounded.move(middle, {-0.008, 0, 0}).force - Vec3(0.04, 0, 0)).norm(), 1e-9);
  Moving one_wall(5, 0.0, 0.35, 0.05);
  middle.coherence = 1.0;
  EXPECT_EQ(one_wall.move(middle, {0.1, 0, 0}).force, Vec3(0, 0, 0)) << "one wall never pulls";
}

TEST(InjectedDamping, IsZeroInFreeSpaceAndFallsBackToTheForce) {
  Moving m(5);
  EXPECT_TRUE(m.move({}, {0.3, 0.1, 0}).zero());
  EXPECT_LE((m.move({{{0, 2, 0}, {0, 0, 0}}, 1000}, {0.1, -0.1, 0}).force - Vec3(0, 2.5, 0)).norm(),
            1e-9);
}

TEST(InjectedDamping, LeavesAForceWithoutStiffnessAsItIs) {
  Moving m(5);
  EXPECT_LE((m.move({{{0, 2, 0}, {0, 0, 0}}, 0}, {0.1, -0.1, 0}).force - Vec3(0, 2, 0)).norm(),
            1e-9)
      << "a weight or a medium's drag is no wall";
}

TEST(InjectedDamping, AddsAtMostItsRatioOfTheContactForce) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int attempt = 0; attempt < 200; ++attempt) {
    Moving m(50, 1, 0.5);
    CouplingInput in = corner(2 * Vec3(u(random), u(random), u(random)), 1000, 200);
    in.contact.torque = 0.1 * Vec3(u(random), u(random), u(random));
    const Wrench& out = m.move(in, 0.5 * Vec3(u(random), u(random), u(random)),
                               5 * Vec3(u(random), u(random), u(random)));
    EXPECT_LE(out.force.norm(), 1.5 * in.contact.force.norm() * (1 + 1e-12));
    EXPECT_GE(out.force.dot(in.contact.force), -1e-12);
  }
  Moving m(5, 0, 0.5);
  EXPECT_LE((m.move(corner({1, 0, 0}, 1000, 0), {-0.5, 0, 0}).force - Vec3(1.5, 0, 0)).norm(), 1e-9)
      << "2.5 N without the bound";
  EXPECT_LE((m.move(corner({1, 0, 0}, 1000, 0), {-0.05, 0, 0}).force - Vec3(1.25, 0, 0)).norm(),
            1e-9)
      << "all of it below the bound";
  EXPECT_LE((m.move(corner({1, 0, 0}, 1000, 0), {0.15, 0, 0}).force - Vec3(0.25, 0, 0)).norm(),
            1e-9)
      << "what is taken is not bounded";
  Moving quiet(5, 0, 0.5, 0.05);
  EXPECT_LE((quiet.move(corner({1, 0, 0}, 1000, 0), {-0.5, 0, 0}).force - Vec3(1.55, 0, 0)).norm(),
            1e-9)
      << "and what is below perception";
  Moving rotation(0, 0.1, 0.5);
  CouplingInput turned = corner({1, 0, 0}, 1000, 0);
  turned.contact.torque = {0.1, 0, 0}, turned.contact_stiffness(3, 3) = 10;
  EXPECT_NEAR(rotation.move(turned, Vec3::Zero(), {-2, 0, 0}).torque.x(), 0.3, 1e-6)
      << "a torque's damper is not bounded";
}

/// A ForceCommand reports the damper's effect on the force, and where it was cut.
TEST(InjectedDamping, ReportsWhatItAddsAndWhereItIsBounded) {
  struct Case {
    double fraction, towards_m_per_s, adds_n;
    bool cut;
  };
  for (const Case& c :
       {Case{0.5, 0.5, 0.5, true}, Case{0.5, 0.05, 0.25, false}, Case{0.5, -0.15, 0.75, false},
        Case{0.0, 0.5, 2.5, false}, Case{0.5, 0.0, 0.0, false}}) {
    SCOPED_TRACE(testing::Message() << c.fraction << ", " << c.towards_m_per_s << " m/s");
    RunningCoupling coupling(Moving::spec(5.0, 0.0, c.fraction, 0.0), {}, kT);
    CouplingInput in = corner({1, 0, 0}, 1000, 0);
    CouplingOutput out = coupling.step(in, kT);
    std::uint64_t before = 0;
    for (int n = 0; n < 300; ++n) {
      before = coupling.counters().bounded;
      in.tool.position.x() -= c.towards_m_per_s * kT;
      out = coupling.step(in, kT);
    }
    EXPECT_NEAR(out.injected_n, c.adds_n, 1e-6);
    EXPECT_EQ(out.bounded, c.cut);
    EXPECT_EQ(coupling.counters().bounded > before, c.cut);
  }
  RunningCoupling coupling(Moving::spec(5.0, 0.0, 0.5, 0.0), {}, kT);
  CouplingInput air;
  for (int n = 0; n < 10; ++n) {
    air.tool.position.x() -= 0.5 * kT;
    const CouplingOutput out = coupling.step(air, kT);
    EXPECT_FALSE(out.bounded || out.injected_n > 0.0) << "nothing is injected without a contact";
  }
}

CouplingSpec with_none(CouplingSpec spec) {
  spec.slow_velocity_hz = spec.velocity_band_m_per_s = 0.0;
  return spec;
}

/// A rested tool moves by one step: the damping is that of the velocity that the spec names.
TEST(InjectedDamping, ActsOnTheVelocityThatTheSpecNames) {
  CouplingSpec spec = Moving::spec(2.0, 0.0, 0.0, 0.0);
  for (const std::uint32_t window : {0U, 4U}) {
    spec.velocity_window = window, spec.velocity_filter_hz = 100.0;
    RunningCoupling coupling(spec, {}, kT);
    CouplingInput in = corner({5, 0, 0}, 1000, 0);
    for (int n = 0; n < 300; ++n)
      coupling.step(in, kT);
    in.tool.position.x() -= 1e-4;
    const double fraction =
        window > 0 ? window_weight(4, 0) : 1.0 - std::exp(-2.0 * std::numbers::pi * 100.0 * kT);
    EXPECT_NEAR(coupling.step(in, kT).wrench.force.x(), 5.0 + 2.0 * 0.1 * fraction, 1e-9) << window;
  }
}

/// Encoder steps along each axis: one is smoothed by the slow velocity, in either direction; for
/// more, the velocity of the spec differs by the band at most.
TEST(InjectedDamping, ActsOnASlowVelocityWithinABand) {
  constexpr double kStep = 1e-4, kSlow = 10.0, kB = 2.0;
  const auto fraction = [](double hz) { return 1.0 - std::exp(-2.0 * std::numbers::pi * hz * kT); };
  for (const std::uint32_t window : {0U, 4U}) {
    CouplingSpec spec = Moving::spec(kB, 0.0, 0.0, 0.0);
    spec.velocity_window = window, spec.velocity_filter_hz = 100.0;
    const double fast = window > 0 ? window_weight(4, 0) : fraction(100.0), speed = kStep / kT;
    spec.slow_velocity_hz = kSlow, spec.velocity_band_m_per_s = fast * speed;
    for (const double steps : {1.0, -1.0, 10.0, -10.0}) {
      RunningCoupling coupling(spec, {}, kT);
      CouplingInput in = corner({5, 0, 0}, 1000, 0);
      for (int n = 0; n < 300; ++n)
        coupling.step(in, kT);
      in.tool.position -= steps * Vec3(kStep, 5.0 * kStep,
                                       0);  // steps along another axis have no effect on this one
      const double damped = std::abs(steps) > 1.0
                                ? steps * fast * speed - std::copysign(fast * speed, steps)
                                : steps * fraction(kSlow) * speed;
      EXPECT_NEAR(coupling.step(in, kT).wrench.force.x(), 5.0 + kB * damped, 1e-9)
          << window << ", " << steps;
    }
    RunningCoupling coupling(spec, {}, kT), without(with_none(spec), {}, kT);
    CouplingInput in = corner({5, 0, 0}, 1000, 0);
    for (int n = 0; n < 3000; ++n) {
      in.tool.position.x() = 1e-3 * std::sin(0.05 * n) + kStep * (n % 3);
      const double off =
          coupling.step(in, kT).wrench.force.x() - without.step(in, kT).wrench.force.x();
      EXPECT_LE(std::abs(off), kB * spec.velocity_band_m_per_s * (1 + 1e-9)) << n;
    }
    EXPECT_TRUE(without.redesign(spec));
    for (int n = 0; n < 300; ++n)
      coupling.step(in, kT), without.step(in, kT);
    in.tool.position.x() -= kStep;
    EXPECT_NEAR(without.step(in, kT).wrench.force.x(), coupling.step(in, kT).wrench.force.x(), 1e-9)
        << "and in a coupling that is changed to it";
  }
}

/// A wall met at half a metre a second: without a bound the first sample returns 5 N, and the hand
/// is 0.3 mm deep.
TEST(InjectedDamping, BeginsAtZeroWithTheContact) {
  for (const double fraction : {0.0, 0.5}) {
    Moving m(10, 0, fraction);
    m.move({}, {-0.5, 0, 0});
    double first = 0.0;
    for (int n = 0; n < 20; ++n) {
      m.pose.position.x() -= 0.5 * kT;
      const double force = 1000 * 0.5 * kT * n;
      CouplingInput in = corner({force, 0, 0}, 1000, 0);
      in.tool = m.pose;
      const double out = m.coupling.step(in, kT).wrench.force.x();
      if (n == 0)
        first = out;
      if (fraction > 0.0) {
        EXPECT_LE(out, 1.5 * force * (1 + 1e-12));
      }
    }
    EXPECT_EQ(first > 4.0, fraction == 0.0);
  }
}

/// Jumps, clutch and gaps: the damping begins at rest each time.
TEST(InjectedDamping, HasNoSpikeAfterAJumpAResetOrAGap) {
  const CouplingInput plane = corner({3, 0, 0}, 1000, 0);
  Moving m(20);
  m.move(plane, {-0.05, 0, 0});
  CouplingInput in = plane;
  for (const double x : {0.4, -0.3}) {
    in.tool.position = Vec3(x, 0, 0);
    EXPECT_LE((m.coupling.step(in, kT).wrench.force - Vec3(3, 0, 0)).norm(), 1e-9) << "jump";
  }
  EXPECT_EQ(m.coupling.counters().pose_jumps, 2U);
  m.coupling.reset({{3, 0, 0}, {0, 0, 0}});
  in.tool.position.x() += 0.004;
  EXPECT_LE((m.coupling.step(in, kT).wrench.force - Vec3(3, 0, 0)).norm(), 1e-9) << "reset";
  in.tool.position.x() -= 0.1;
  EXPECT_LE((m.coupling.step(in, 0.5).wrench.force - Vec3(3, 0, 0)).norm(), 1e-9) << "gap";
}

}  // namespace injected_damping_test
}  // namespace voxtouch::coupling
