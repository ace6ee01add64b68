// The published examples. Their mass range is not given; 0.05 to 0.1 kg is used here.
#include <gtest/gtest.h>

#include "tests/unit/coupling_design/designer_support.hpp"

namespace voxtouch::coupling::design {
namespace designer_examples_test {

using namespace testing;

double margin_of(const DesignProblem& r, double cutoff_hz, double ratio, double damping,
                 double filter_hz, double stiffness) {
  CouplingSpec spec;
  spec.cutoff_hz = cutoff_hz, spec.damping_ratio = ratio, spec.injected_damping_ns_per_m = damping;
  spec.velocity_filter_hz = filter_hz, spec.gain = stiffness / r.contact.all_points;
  spec.damping_force_ratio = 0.0;
  return judge_coupling(r, spec).translation.gain_margin;
}

TEST(PublishedExample, FreeUndampedStylusIsInfeasible) {
  DesignProblem r = stylus();
  r.goals.allow_injected_damping = false;
  const Design d = designed(r);
  EXPECT_EQ(d.status, DesignStatus::kInfeasible);
  EXPECT_NEAR(d.translation.displayed_stiffness, 0.38, 0.005);
  // The published 13 Ns/m scale this result to 1000 N/m: the limit for a linear contact. Rule P,
  // which also covers unilateral contacts, requires more.
  EXPECT_NEAR(r.device.translation.damping * 1000.0 / d.translation.displayed_stiffness, 13.0, 0.5);
  EXPECT_GT(damping_required_any_cutoff(r), 13.0);
  EXPECT_LT(damping_required_any_cutoff(r), 20.0);
}

TEST(PublishedExample, FreeDampedStylusDisplaysPart) {
  const DesignProblem r = stylus();
  const Design d = designed(r);
  EXPECT_EQ(d.status, DesignStatus::kStiffnessReduced);
  EXPECT_EQ(d.spec.cutoff_hz, 60.0);
  // Published: 6.2 Ns/m and 288 N/m. Those are certified here too; but nine tenths of that damping
  // are within a tenth of the best stiffness, and the gentler one of such is taken.
  EXPECT_NEAR(margin_of(r, 60.0, 1.0, 6.18, 50.0, 288.0), 2.0, 0.04);
  EXPECT_NEAR(d.spec.injected_damping_ns_per_m, 0.9 * 6.18, 0.01);
  EXPECT_GT(d.translation.displayed_stiffness, 0.9 * 288.0);
}

TEST(PublishedExample, GrippedStylusDisplaysPartUndamped) {
  DesignProblem r = stylus();
  r.hand.translation = kFirmPen;
  r.goals.allow_injected_damping = false;
  const Design d = designed(r);
  EXPECT_EQ(d.status, DesignStatus::kStiffnessReduced);
  EXPECT_EQ(d.spec.cutoff_hz, 80.0);
  EXPECT_NEAR(d.translation.displayed_stiffness, 230.0, 2.0);
}

TEST(PublishedExample, DampedRobotNeedsOnlyMoreBandwidth) {
  const Design d = designed(robot(2.0, 5.0, 50.0));
  EXPECT_EQ(d.status, DesignStatus::kBandwidthRaised);
  EXPECT_EQ(d.spec.cutoff_hz, 40.0);
  EXPECT_EQ(d.spec.gain, 1.0);
  EXPECT_EQ(d.spec.injected_damping_ns_per_m, 0.0);
}

TEST(PublishedExample, SoftWallIsDisplayedAsRequested) {
  DesignProblem r = robot(2.0, 5.0, 50.0);
  r.contact.all_points = 400.0;
  const Design d = designed(r);
  EXPECT_EQ(d.status, DesignStatus::kAsRequested);
  EXPECT_EQ(d.spec.cutoff_hz, 5.0);
  EXPECT_EQ(d.spec.gain, 1.0);
  EXPECT_TRUE(d.reasons.empty());
}

TEST(PublishedExample, LightlyDampedRobotGetsDamping) {
  const Design d = designed(robot(2.0, 10.0, 10.0));
  EXPECT_EQ(d.status, DesignStatus::kDampingAdded);
  EXPECT_EQ(d.spec.cutoff_hz, 80.0);
  EXPECT_EQ(d.spec.gain, 1.0);
  // Published: 35 Ns/m, half of what the noise of 200 N permits at 200 Hz. It is certified here
  // too; three tenths of the value permitted at 100 Hz, which is less, are certified as well.
  EXPECT_GE(margin_of(robot(2.0, 10.0, 10.0), 80.0, 0.577, 34.95, 200.0, 2000.0), 2.0);
  EXPECT_NEAR(d.spec.injected_damping_ns_per_m, 32.2, 0.1);
  EXPECT_EQ(d.spec.velocity_filter_hz, 100.0);
}

/// Of 45 g, with an encoder of 0.03 mm, 1 kHz and a delay of 1 ms: how much damping 0.05 N of noise
/// leave decides. With the velocity of no first-order filter, however much damping, is it more than
/// 500 N/m.
TEST(Stylus, VelocityWindowsRaiseItsStiffness) {
  DesignProblem r = stylus();
  r.device.translation.inertia_min = r.device.translation.inertia_max = 0.045;
  r.device.timing.consecutive_losses = 1;
  r.goals = {}, r.goals.free_cap = true;  // as a scene without goals
  const Design d = designed(r);
  EXPECT_EQ(d.spec.kind, "direct");
  EXPECT_GE(d.translation.displayed_stiffness, 650.0);
  EXPECT_GE(d.translation.gain_margin, 2.0 * (1.0 - 1e-9));
  ASSERT_GT(d.spec.velocity_window, 0U);
  EXPECT_LE(d.spec.injected_damping_ns_per_m * 0.03 *
                window_step_ratio(static_cast<int>(d.spec.velocity_window)),
            0.05 * (1.0 + 1e-9));
  AxisProblem axis = axis_problems(r)[0];
  axis.damping_force_ratio = 0.0;
  LoopController law{.law = LoopController::Law::kDirect};
  double most = 0.0;
  for (double hz = 20.0; hz < 600.0; hz *= 1.04)
    for (const double fraction : {0.4, 0.6, 0.8, 0.9, 1.0}) {
      law.use({hz});
      law.injected_damping = fraction * damping_limit(axis, {hz});
      most = std::max(most, certified_stiffness(axis, law, most));
    }
  std::printf("%.1f N/m on a window of %u, at most %.1f N/m behind a filter\n",
              d.translation.displayed_stiffness, d.spec.velocity_window, most);
  EXPECT_LT(most, 500.0);
  EXPECT_GT(most, 490.0);
}

}  // namespace designer_examples_test
}  // namespace voxtouch::coupling::design
