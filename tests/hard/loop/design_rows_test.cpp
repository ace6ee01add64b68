/// The hard cases of the loop, one invariant each.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/coupling/design/certificates.hpp"
#include "tests/support/coupling_models/nonlinear_loop.hpp"

namespace voxtouch::test {
namespace design_rows_test {

constexpr double kPi = 3.14159265358979323846;

coupling::design::LoopController filter(double cutoff_hz, double damping_ratio,
                                        double injected = 0.0) {
  coupling::design::LoopController out;
  out.w0_rad_per_s = 2.0 * kPi * cutoff_hz, out.damping_ratio = damping_ratio;
  out.injected_damping = injected, out.velocity_filter_rad_per_s = 628.0;
  return out;
}

/// A stylus with 5 Ns/m injected and a 50 Hz filter: unstable from 819 N/m on, shown at half of
/// that.
coupling_models::NonlinearLoop damped_phantom() {
  coupling_models::NonlinearLoop loop;
  loop.plant = {0.075, 0.005, 0.0, 0.0, 0.0, 1e-3, 1e-3, 0.0};
  loop.controller = filter(50.0, 0.707, 5.0);
  loop.contact_stiffness = 0.5 * 819.1;
  loop.damping_only_in_contact = true;
  loop.resolution = 3e-5;
  loop.push = 1.0, loop.start_speed = 0.1;
  loop.duration_s = 10.0;
  return loop;
}

/// A robot of 2 kg, 50 Ns/m with a 40 Hz filter: unstable from 4970 N/m on, shown at half of that.
coupling_models::NonlinearLoop robot() {
  coupling_models::NonlinearLoop loop;
  loop.plant = {2.0, 50.0, 0.0, 0.0, 0.0, 1e-3, 2.3e-3, 3e-3};
  loop.controller = filter(40.0, 0.577);
  loop.contact_stiffness = 0.5 * 4970.0;
  loop.resolution = 2e-5;
  loop.push = 5.0, loop.start_speed = 0.05;
  loop.duration_s = 10.0;
  return loop;
}

/// Doubling k under a constant force P moves the device from P/k to P/(2k) and supplies P^2/(2k),
/// exactly the stored energy. Energy beyond that equals the dissipation of the device's damping on
/// the path: zero for a slow ramp.
TEST(HardCaseL1, RampLimitsTheEnergyOfAStiffnessStep) {
  for (coupling_models::NonlinearLoop loop : {robot(), damped_phantom()}) {
    loop.contact_stiffness *= 0.5;
    loop.resolution = 0.0;
    loop.longest_s = loop.duration_s;
    const double stored = 0.5 * loop.push * loop.push / loop.contact_stiffness,
                 before = coupling_models::simulate(loop).work_j;
    const auto created = [&](double ramp_s) {
      loop.disturbance = {.at_s = 5.0, .stiffness_factor = 2.0, .stiffness_ramp_s = ramp_s};
      const coupling_models::NonlinearVerdict v = coupling_models::simulate(loop);
      EXPECT_TRUE(v.stable);
      EXPECT_NEAR(v.end_position, loop.push / (2.0 * loop.contact_stiffness), 1e-6);
      return (v.work_j - before - stored) / stored;
    };
    const double shortest = 5.0 / loop.controller.w0_rad_per_s;
    const double step = created(0.0), ramped = created(shortest), slow = created(20.0 * shortest);
    EXPECT_LT(ramped, step);
    EXPECT_LT(slow, 0.1 * ramped);
    EXPECT_GT(slow, -1e-6);
  }
}

TEST(HardCaseL2, QuantiserLimitCycleIsBounded) {
  for (coupling_models::NonlinearLoop loop : {robot(), damped_phantom()}) {
    loop.start_speed = 0.01;
    loop.damping_only_in_contact = false;
    for (const coupling_models::WallLaw wall :
         {coupling_models::WallLaw::kBilateral, coupling_models::WallLaw::kUnilateral}) {
      loop.wall = wall;
      const double bound =
          loop.resolution * coupling_models::quantiser_gain(loop, loop.contact_stiffness);
      EXPECT_LT(bound, 40.0 * loop.resolution);
      for (int i = 0; i < 40; ++i) {
        loop.push = 1.0 + 0.013 * i;  // rests at all positions between two steps
        const coupling_models::NonlinearVerdict v = coupling_models::simulate(loop);
        EXPECT_EQ(v.outcome, coupling_models::LoopOutcome::kRest);
        EXPECT_LE(v.late_amplitude, bound) << i;
      }
    }
  }
}

TEST(HardCaseL2, TheBoundOfAnOverdampedLoopIsItsGainAtRest) {
  coupling_models::NonlinearLoop
      loop;  // its response has one sign, so the sum of amounts is the amount of the sum
  loop.plant = {0.1, 60.0, 0.0, 0.0, 200.0, 1e-3, 0.0, 0.0};
  loop.controller.law = coupling::design::LoopController::Law::kDirect;
  EXPECT_NEAR(coupling_models::quantiser_gain(loop, 300.0), 300.0 / 500.0, 0.01);
  EXPECT_EQ(coupling_models::quantiser_gain(loop, 1e6), 1.0);  // unstable: no bound
}

TEST(HardCaseL2, FrictionOfHalfAStepLeavesNoLimitCycle) {
  coupling_models::NonlinearLoop stylus =
      damped_phantom();  // with damping: the injected damping has steps as well
  stylus.plant.mass = 0.05, stylus.plant.damping = 0.5;
  stylus.controller = filter(50.0, 0.707);
  stylus.contact_stiffness = 42.0;
  for (coupling_models::NonlinearLoop loop : {robot(), stylus}) {
    const double step = loop.contact_stiffness * loop.resolution;
    double without = 0.0;
    for (const double fraction : {0.0, 0.5, 1.0}) {
      loop.coulomb_friction = fraction * step;
      double worst = 0.0;
      for (int i = 0; i < 40; ++i) {
        loop.push = 1.0 + 0.013 * i;
        worst = std::max(worst, coupling_models::simulate(loop).late_amplitude);
      }
      if (fraction == 0.0) {
        without = worst;
      } else {
        EXPECT_LE(worst, 0.01 * loop.resolution) << fraction;
      }
    }
    EXPECT_LE(without, 1.5 * loop.resolution);
  }
}

TEST(HardCaseL3, ChatterIsAtMostOneForceStep) {
  for (coupling_models::NonlinearLoop loop : {robot(), damped_phantom()}) {
    loop.plant.hand_mass = 0.1, loop.plant.hand_damping = 3.0, loop.plant.hand_stiffness = 200.0;
    loop.push = 0.5 * loop.resolution * loop.plant.hand_stiffness, loop.start_speed = 0.0;
    loop.start_position = 0.5 * loop.resolution;
    loop.measurement_noise = 0.5 * loop.resolution;
    loop.controller.injected_damping = 0.0;
    loop.duration_s = loop.longest_s = 1000.0;  // 1e6 samples
    const coupling_models::NonlinearVerdict v = coupling_models::simulate(loop);
    EXPECT_GT(v.late_effort, 0.0);
    // One step of force, and the largest overshoot of the filter (the norm of its impulse
    // response).
    const double overshoot = coupling::design::overshoot_shape(loop.controller.damping_ratio);
    EXPECT_LE(v.late_effort, overshoot * loop.contact_stiffness * loop.resolution);
  }
}

TEST(HardCaseL4, StableGrippedIsNotStableReleased) {
  coupling_models::NonlinearLoop loop;
  loop.controller = filter(5.0, 1.0);
  loop.resolution = 1e-5;
  loop.push = 0.3, loop.start_speed = 0.02;
  loop.duration_s = 30.0;
  const coupling::design::LoopPlant normal{0.075, 0.005, 0.1, 3.0, 200.0, 1e-3, 1e-3, 0.0},
      light{0.075, 0.005, 0.02, 0.5, 20.0, 1e-3, 1e-3, 0.0},
      released{0.075, 0.005, 0.0, 0.0, 0.0, 1e-3, 1e-3, 0.0},
      hand_mass_only{0.075, 0.005, 0.1, 0.0, 0.0, 1e-3, 1e-3, 0.0};
  loop.contact_stiffness = 190.0;
  loop.plant = normal;
  EXPECT_TRUE(coupling_models::simulate(loop).stable);
  for (const coupling::design::LoopPlant& p : {light, released, hand_mass_only}) {
    loop.plant = p;
    EXPECT_FALSE(coupling_models::simulate(loop).stable) << p.hand_mass;
  }
  loop.contact_stiffness = 0.5 * 13.0;
  loop.plant = light;
  EXPECT_TRUE(coupling_models::simulate(loop).stable);
}

TEST(HardCaseL5, FivePercentLossLeavesADesignStable) {
  for (coupling_models::NonlinearLoop loop : {robot(), damped_phantom()}) {
    loop.jitter = 0.2, loop.delay_jitter_s = 1e-3;
    for (const double loss : {0.01, 0.03, 0.05})
      for (loop.seed = 0; loop.seed < 20; ++loop.seed) {
        loop.loss = loss;
        EXPECT_TRUE(coupling_models::simulate(loop).stable) << loss << " seed " << loop.seed;
      }
  }
}

TEST(HardCaseL5, DelayChangeWithinTheMarginComesToRest) {
  for (coupling_models::NonlinearLoop loop : {robot(), damped_phantom()}) {
    loop.duration_s = 20.0;
    for (const double change : {-1e-3, 0.5e-3, 1e-3, 2e-3}) {
      loop.disturbance = {.at_s = 5.0, .more_delay_s = change};
      const coupling_models::NonlinearVerdict v = coupling_models::simulate(loop);
      EXPECT_EQ(v.outcome, coupling_models::LoopOutcome::kRest) << change;
      EXPECT_NEAR(v.end_position, loop.push / loop.contact_stiffness, 2.0 * loop.resolution);
    }
  }
}

TEST(HardCaseL5, SilenceFadesTheForceAndItRecovers) {
  for (coupling_models::NonlinearLoop loop : {robot(), damped_phantom()}) {
    loop.fade_after_lost = 3;
    loop.disturbance = {.at_s = 5.0, .silence_s = 0.1};
    loop.duration_s = 40.0;
    const coupling_models::NonlinearVerdict v = coupling_models::simulate(loop);
    EXPECT_EQ(v.statistics.longest_loss, 100u);
    EXPECT_EQ(v.outcome, coupling_models::LoopOutcome::kRest);
    EXPECT_NEAR(v.end_position, loop.push / loop.contact_stiffness, 2.0 * loop.resolution);
    const double fall_s = 0.1 + coupling_models::kFadeInS;
    EXPECT_LE(v.deepest, loop.push / loop.contact_stiffness +
                             0.5 * loop.push / loop.plant.mass * fall_s * fall_s);
  }
}

TEST(HardCaseL5, EndlessSilenceLeavesNoForce) {
  coupling_models::NonlinearLoop loop = damped_phantom();
  loop.disturbance = {.at_s = 2.0, .silence_s = 1e9};
  loop.duration_s = 3.5, loop.longest_s = 3.5;
  const coupling_models::NonlinearVerdict held =
      coupling_models::simulate(loop);  // the last force, which nearly balances the hand
  loop.fade_after_lost = 3;
  const coupling_models::NonlinearVerdict faded = coupling_models::simulate(loop);
  EXPECT_EQ(faded.late_effort, 0.0);
  EXPECT_GT(faded.end_position, held.end_position + 1.0);  // no force opposes the hand
}

TEST(HardCaseL7, SaturationLeavesADesignStable) {
  for (coupling_models::NonlinearLoop loop : {robot(), damped_phantom()}) {
    loop.push = 2.0;
    for (const double limit : {2.0 / 0.6, 4.0}) {
      loop.max_effort = limit;  // pressed to 60 % of it and more, with an impact that exceeds it
      for (const double speed : {0.5, 1.0}) {
        loop.start_speed = speed;
        const coupling_models::NonlinearVerdict v = coupling_models::simulate(loop);
        EXPECT_EQ(v.outcome, coupling_models::LoopOutcome::kRest);
        EXPECT_GT(v.statistics.saturated, 5u);
        EXPECT_NEAR(v.end_position, loop.push / loop.contact_stiffness, 2.0 * loop.resolution);
      }
    }
  }
}

TEST(HardCaseL8, WorstMassIsAtAnEndOfTheRange) {
  coupling_models::NonlinearLoop loop;
  loop.controller = filter(5.0, 0.707);
  loop.push = 3.0, loop.start_speed = 0.02;
  loop.duration_s = 30.0;
  const auto limit = [&](double mass) {
    loop.plant = {mass, 10.0, 0.0, 0.0, 0.0, 1e-3, 2e-3, 3e-3};
    return coupling_models::simulated_limit(loop, 20.0, 5e3, 0.02);
  };
  const double worst = std::min(limit(2.0), limit(10.0));
  for (const double mass : {2.5, 3.5, 5.0, 7.0, 8.5})
    EXPECT_GE(limit(mass), 0.98 * worst) << mass;
}

}  // namespace design_rows_test
}  // namespace voxtouch::test
