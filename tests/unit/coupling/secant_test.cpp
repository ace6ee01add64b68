// The cap on the contact's stiffness caps the increment: the force reaches the cap times the depth, and not half of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "core/coupling/running_coupling.hpp"

namespace voxtouch::coupling {
namespace secant_test {

constexpr double kT = 1e-3, kCap = 300.0, kRadius = 0.01, kStep = 1e-5;

/// A ball pressed by `depth` into the plane z = 0 from above, as the contact models have it: points of `k` each, `layer` the depth beyond which
/// a point's push grows no more and counts in the stiffness all the same.
CouplingInput ball(double depth, double k, double layer = std::numeric_limits<double>::infinity()) {
  constexpr int kRings = 60;
  CouplingInput in;
  for (int i = 0; i < kRings; ++i) {
    const double angle = 0.5 * std::numbers::pi * (i + 0.5) / kRings, own = depth - kRadius * (1.0 - std::cos(angle));
    if (own <= 0.0) continue;
    const double stiffness = k * 6.0 * (i + 0.5);  // points of equal areas
    in.contact.force.z() += stiffness * std::min(own, layer);
    in.contact_stiffness_n_per_m += stiffness;
    in.contact_stiffness(2, 2) += stiffness;
    in.contact_depth_m = std::max(in.contact_depth_m, std::min(own, layer));
  }
  in.tool.position.z() = -depth;
  return in;
}

RunningCoupling direct(double cap = kCap) {
  CouplingSpec spec;
  spec.kind = "direct", spec.stiffness_cap_n_per_m = cap;
  return RunningCoupling(spec, {}, kT);
}

/// Slowly, so that nothing hangs on time.
double press(RunningCoupling& coupling, const CouplingInput& in) { return coupling.step(in, kT).wrench.force.z(); }

TEST(Secant, UnderABallIsTheCapButForTheDepthThatTheBallTakesToBecomeAsStiff) {
  for (const double k : {0.2, 1.0, 20.0}) {
    RunningCoupling coupling = direct();
    double before = 0.0, as_stiff = 0.0;
    for (double depth = 0.0; depth <= kRadius; depth += kStep) {
      const CouplingInput in = ball(depth, k);
      const double force = press(coupling, in);
      if (in.contact_stiffness_n_per_m < kCap) as_stiff = depth;
      ASSERT_GE(force, before) << k << ": falls at " << depth;
      ASSERT_LE(force - before, kCap * kStep * (1 + 1e-9)) << k << ": steeper than the cap at " << depth;
      ASSERT_LE(force, in.contact.force.z() * (1 + 1e-12));
      ASSERT_GE(force, 0.999 * std::min(in.contact.force.z(), kCap * (depth - as_stiff - 2 * kStep))) << k << " at " << depth;
      if (depth > 20.0 * as_stiff + 1e-3) {
        ASSERT_GE(force, 0.95 * kCap * depth) << k << " at " << depth;
      }
      before = force;
    }
    EXPECT_GT(before, 0.9 * kCap * kRadius) << k;
  }
}

TEST(Secant, FallsOnTheWayOutAsItRoseAndGivesNoEnergy) {
  for (const double k : {0.2, 1.0, 20.0}) {
    RunningCoupling coupling = direct();
    std::vector<double> in;
    double work = 0.0, before = 0.0;
    for (double depth = 0.0; depth <= 0.008; depth += kStep) in.push_back(press(coupling, ball(depth, k)));
    for (std::size_t n = 1; n < in.size(); ++n) work += 0.5 * (in[n] + in[n - 1]) * kStep;
    before = in.back();
    for (std::size_t n = in.size() - 1; n-- > 0;) {
      const double force = press(coupling, ball(kStep * static_cast<double>(n), k));
      ASSERT_LE(force, in[n] * (1 + 1e-9) + kCap * kStep) << k << " at " << n;
      ASSERT_GE(force, in[n] - 0.1 * in.back()) << k << " at " << n << ": the scale lags by milliseconds, no more";
      work -= 0.5 * (force + before) * kStep;
      before = force;
    }
    EXPECT_GE(work, -1e-9 * kCap);
    EXPECT_EQ(press(coupling, {}), 0.0);
    EXPECT_NEAR(press(coupling, ball(kStep, k)), in[1], 1e-12) << "the next contact begins as the first one did";
  }
}

/// A model that knows depth in one layer: its sum over points grows, its mean depth falls, and the hand's force must not.
TEST(Secant, NeverFallsWhileTheHandGoesDeeperAlsoWhereDepthIsHeld) {
  for (const double k : {1.0, 20.0}) {
    RunningCoupling coupling = direct();
    double before = 0.0;
    for (double depth = 0.0; depth <= kRadius; depth += kStep) {
      const CouplingInput in = ball(depth, k, 1e-3);
      const double force = press(coupling, in);
      ASSERT_GE(force, before * (1 - 1e-3)) << k << " at " << depth;
      ASSERT_LE(force, kCap * 1e-3 * (1 + 1e-9)) << "no more than the depth that is told";
      before = force;
    }
    EXPECT_GT(before, 0.9 * kCap * 1e-3) << k;
  }
}

TEST(Secant, LeavesWhatIsBelowTheCapToTheLastBit) {
  RunningCoupling coupling = direct(1e5);
  for (double depth = 0.0; depth <= kRadius; depth += kStep) {
    const CouplingInput in = ball(depth, 0.5);
    const CouplingOutput out = coupling.step(in, kT);
    ASSERT_EQ(out.wrench.force, in.contact.force);
    ASSERT_EQ(out.scale, 1.0);
  }
}

/// Whatever way the hand takes: at least what the scale leaves, at most the wrench itself and, but for a time that runs out, the cap times the depth.
TEST(Secant, StaysBetweenItsBoundsOnAnyWay) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> u(-1, 1);
  CouplingSpec spec;
  spec.kind = "direct", spec.stiffness_cap_n_per_m = kCap;
  StiffnessCap cap(spec);
  cap.step({}, kT);
  double depth = 0.0, k = 1.0;
  for (int n = 0; n < 50'000; ++n) {
    depth = std::clamp(depth + 1e-4 * u(random), -1e-3, 5e-3);
    k = std::clamp(k * std::exp(0.05 * u(random)), 0.05, 50.0);
    const CouplingInput in = ball(depth, k);
    const CapScales scales = cap.step(in, kT);
    ASSERT_LE(scales.wrench, 1.0);
    ASSERT_GE(scales.wrench, scales.stiffness);
    ASSERT_LE(scales.stiffness * in.contact_stiffness_n_per_m, kCap * (1 + 1e-12));
  }
  for (int n = 0; n < 2000; ++n) cap.step(ball(2e-3, 50.0), kT);
  const CouplingInput in = ball(2e-3, 50.0);
  EXPECT_LE(cap.step(in, kT).wrench * in.contact.force.z(), kCap * 2e-3 * (1 + 1e-6));
}

/// Two scenes that fade into each other, or two objects: the deepest point may be another one, with the wrench as it was.
TEST(Secant, MakesNoStepWhereTheDeepestPointIsSuddenlyAnother) {
  for (const double other : {0.1, 10.0}) {
    RunningCoupling coupling = direct();
    press(coupling, {});
    double before = 0.0;
    for (double depth = 0.0; depth <= 0.005; depth += kStep) before = press(coupling, ball(depth, 20.0));
    CouplingInput in = ball(0.005, 20.0);
    in.contact_depth_m *= other;
    for (int n = 0; n < 500; ++n) {
      const double force = press(coupling, in);
      ASSERT_LE(std::abs(force - before), 0.051 * before) << other << " after " << n;
      before = force;
    }
  }
}

TEST(Secant, BeginsWithTheScaleWhereAContactIsMetDeepInside) {
  RunningCoupling coupling = direct();
  const CouplingInput in = ball(0.005, 20.0);
  coupling.reset({});
  double force = 0.0;
  for (int n = 0; n < 500; ++n) force = press(coupling, in);
  EXPECT_NEAR(force, kCap / in.contact_stiffness_n_per_m * in.contact.force.z(), 1e-9);
}

/// Force and torque keep their proportion, and where turning decides the cap the increments are those that it leaves.
TEST(Secant, KeepsTheWrenchsDirectionAndBothCaps) {
  CouplingSpec spec;
  spec.kind = "direct", spec.stiffness_cap_n_per_m = 1e4, spec.stiffness_cap_nm_per_rad = 0.03;
  RunningCoupling coupling(spec, {}, kT);
  coupling.step({}, kT);
  const double lever = 0.02, shown = 0.03 / (lever * lever);  // N/m that turning leaves, a little less with both together
  double before = 0.0;
  for (double depth = 0.0; depth <= 0.008; depth += kStep) {
    CouplingInput in = ball(depth, 20.0);
    const double k = in.contact_stiffness_n_per_m;
    in.contact.torque = Vec3(lever * in.contact.force.z(), 0, 0);
    in.contact_stiffness(3, 3) = lever * lever * k;
    in.contact_stiffness(2, 3) = in.contact_stiffness(3, 2) = lever * k;
    const Wrench out = coupling.step(in, kT).wrench;
    ASSERT_NEAR(out.torque.x(), lever * out.force.z(), 1e-12);
    ASSERT_LE(out.force.z() - before, shown * kStep);
    before = out.force.z();
  }
  EXPECT_GT(before, 0.85 * shown * 0.008);
}

TEST(Secant, ADepthThatIsNoNumberMakesTheSampleUnusable) {
  CouplingInput in = ball(0.005, 20.0);
  EXPECT_TRUE(usable(in));
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1e13, 1e13}) {
    in.contact_depth_m = bad;
    EXPECT_FALSE(usable(in));
  }
}

}  // namespace secant_test
}  // namespace voxtouch::coupling
