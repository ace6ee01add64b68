// Force and torque together; caps, gains and limits.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "tests/unit/coupling_design/designer_support.hpp"

namespace voxtouch::coupling::design {
namespace designer_axes_test {

using namespace testing;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(ForceAndTorque, HaveOneFilterAndTwoDampings) {
  const DesignProblem r = sim_arm();
  const Design d = designed(r);
  EXPECT_NE(d.status, DesignStatus::kInfeasible);
  EXPECT_GE(d.translation.gain_margin, 2.0);
  EXPECT_GE(d.rotation.gain_margin, 2.0);
  EXPECT_EQ(d.spec.injected_damping_nms_per_rad, d.rotation.injected_damping);
  EXPECT_TRUE(std::isfinite(d.spec.stiffness_cap_n_per_m) &&
              std::isfinite(d.spec.stiffness_cap_nm_per_rad));
  EXPECT_NEAR(d.rotation.displayed_stiffness, d.spec.gain * r.contact_rotation.all_points, 1e-9);
  EXPECT_NEAR(d.translation.displayed_stiffness, d.spec.gain * r.contact.all_points, 1e-9);
}

TEST(ForceAndTorque, TheWeakerAxisSetsTheGain) {
  DesignProblem r = sim_arm();
  r.goals.allow_injected_damping = false;
  r.device.rotation.damping = 0.02;
  const Design d = designed(r);
  EXPECT_LT(d.spec.gain, 1.0);
  EXPECT_GT(d.translation.gain_margin, 2.5);
  EXPECT_NEAR(d.rotation.gain_margin, 2.0, 0.01);
  r.goals.free_cap = true;
  const Design capped = designed(r);
  EXPECT_GT(capped.translation.displayed_stiffness, 1.2 * d.translation.displayed_stiffness);
}

TEST(ForceAndTorque, WithoutCapsTogetherMayBeTwiceAsStiff) {
  const DesignProblem r = sim_arm();
  CouplingSpec spec = designed(r).spec;
  const Design capped = judge_coupling(r, spec);
  spec.stiffness_cap_n_per_m = spec.stiffness_cap_nm_per_rad = kInfinity;
  const Design free = judge_coupling(r, spec);
  EXPECT_NEAR(2.0 * free.translation.gain_margin, capped.translation.gain_margin, 1e-9);
  EXPECT_NEAR(2.0 * free.rotation.gain_margin, capped.rotation.gain_margin, 1e-9);
  // Source of that factor: one point with an arm has both bounds at once.
  const Eigen::Vector2d along(1.0, 0.1);
  const Eigen::Matrix2d k = 100.0 * along * along.transpose();
  const Eigen::Vector2d scale(1.0 / std::sqrt(k(0, 0)), 1.0 / std::sqrt(k(1, 1)));
  const Eigen::Matrix2d relative = scale.asDiagonal() * k * scale.asDiagonal();
  EXPECT_NEAR(relative.trace(), 2.0, 1e-12);
  EXPECT_NEAR(relative.determinant(), 0.0, 1e-12);
}

TEST(ForceAndTorque, RotationIsSkippedForADeviceWithoutTorque) {
  DesignProblem r = stylus();
  r.device.rotation.damping = std::nan("");
  r.contact_rotation = {-1.0, -1.0};
  const Design d = designed(r);
  EXPECT_EQ(d.rotation.displayed_stiffness, 0.0);
  EXPECT_EQ(d.rotation.requested_stiffness, 0.0);
  EXPECT_TRUE(std::isinf(d.spec.stiffness_cap_nm_per_rad));
}

TEST(FreeCap, KeepsEachPointsOwnStiffness) {
  DesignProblem r = stylus();
  const Design scaled = designed(r);
  r.goals.free_cap = true;
  const Design capped = designed(r);
  EXPECT_EQ(capped.spec.gain, 1.0);
  EXPECT_NEAR(capped.spec.stiffness_cap_n_per_m, capped.translation.displayed_stiffness, 1e-9);
  EXPECT_NEAR(capped.translation.displayed_stiffness, scaled.translation.displayed_stiffness, 1e-6);
  r.contact.one_point = 600.0;
  const Design point = designed(r);
  EXPECT_NEAR(point.spec.gain, point.translation.displayed_stiffness / 600.0, 1e-3);
  EXPECT_NEAR(point.spec.gain * point.spec.stiffness_cap_n_per_m,
              point.translation.displayed_stiffness, 1e-9);
}

TEST(FreeCap, IsWhatADirectCouplingNeeds) {
  DesignProblem r = stylus();
  r.goals.kind = "direct";
  const Design refused = designed(r);
  EXPECT_EQ(refused.status, DesignStatus::kInfeasible);
  r.goals.free_cap = true;
  const Design capped = designed(r);
  EXPECT_EQ(capped.status, DesignStatus::kStiffnessReduced);
  EXPECT_GT(capped.translation.displayed_stiffness, 250.0);
}

TEST(Design, NeverExceedsTheDevicesStiffness) {
  DesignProblem r = robot(2.0, 5.0, 50.0);
  r.device.translation.max_stiffness = 300.0;
  for (const char* kind : {"shaping_filter", "direct", "spring_damper", "auto"})
    for (const bool cap : {false, true}) {
      r.goals.kind = kind, r.goals.free_cap = cap;
      const Design d = designed(r);
      EXPECT_LE(d.translation.displayed_stiffness, 300.0 * (1 + 1e-9)) << kind << cap;
      EXPECT_EQ(d.translation.requested_stiffness, 300.0);
      if (std::string(kind) == "shaping_filter") {
        EXPECT_EQ(d.status, DesignStatus::kAsRequested);
      }
    }
}

TEST(Design, ReportsTheMaximumApproachSpeed) {
  DesignProblem r = robot(2.0, 5.0, 50.0);
  EXPECT_EQ(designed(r).max_approach_m_per_s, 0.0);
  r.goals.force_layer_depth_m = 0.004;
  const Design d = designed(r);
  // Slowest timing, heaviest hand on the heaviest device; M/B of the released one is the shorter
  // stopping distance.
  const double tau = d.lag_s + 0.6e-3 + (2e-3 + 2.2e-3) + 3e-3;
  double stop = 0.0;
  const AxisProblem problem = axis_problems(r)[0];
  for (const DesignCase& one : problem.cases) {
    const double m = one.plant.mass + one.plant.hand_mass,
                 b = one.plant.damping + one.plant.hand_damping;
    stop = std::max(stop, std::min(std::sqrt(m / r.contact.one_point), m / b));
  }
  EXPECT_NEAR(d.max_approach_m_per_s, 0.004 / (tau + stop), 1e-9);
  r.contact.one_point = 200.0;
  EXPECT_GE(designed(r).max_approach_m_per_s, d.max_approach_m_per_s);
}

}  // namespace designer_axes_test
}  // namespace voxtouch::coupling::design
