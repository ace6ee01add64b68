// Evaluates a coupling that was chosen by hand, also by rule P (any passive hand).
#include <gtest/gtest.h>

#include <stdexcept>

#include "core/coupling/design/certificates.hpp"
#include "tests/unit/coupling_design/designer_support.hpp"

namespace voxtouch::coupling::design {
namespace designer_given_coupling_test {

using namespace testing;

TEST(GivenCoupling, RefusesWhatTheMarginDoesNotCover) {
  const DesignProblem r = stylus();
  CouplingSpec spec = designed(r).spec;
  spec.gain *= 1.05;
  const Design judged = judge_coupling(r, spec);
  EXPECT_EQ(judged.status, DesignStatus::kInfeasible);
  EXPECT_TRUE(has_reason(judged, DesignLimit::kGainMargin));
  EXPECT_EQ(judged.spec.gain, spec.gain);
}

TEST(GivenCoupling, HoldsAnyPassiveHandAgainstRuleP) {
  DesignProblem r = robot(2.0, 5.0, 50.0);
  r.hand.translation.any_passive = true;
  CouplingSpec spec = designed(r).spec;
  EXPECT_EQ(judge_coupling(r, spec).status, DesignStatus::kAsRequested);
  spec.gain *= 1.03;  // which the released device alone would bear with the margin
  const Design judged = judge_coupling(r, spec);
  EXPECT_LT(judged.translation.spectral_radius, 1.0);
  EXPECT_EQ(judged.status, DesignStatus::kInfeasible);
}

TEST(GivenCoupling, RefusesThePapersFilterOnAFreeStylus) {
  CouplingSpec paper;
  paper.cutoff_hz = 5.0, paper.damping_ratio = 1.0;
  const Design judged = judge_coupling(stylus(), paper);
  EXPECT_EQ(judged.status, DesignStatus::kInfeasible);
  EXPECT_LT(judged.translation.critical_stiffness, 0.1);
}

TEST(GivenCoupling, RefusesTooStrongOrTooNoisyDamping) {
  DesignProblem r = stylus();
  CouplingSpec spec = designed(r).spec;
  spec.injected_damping_ns_per_m *= 1.2, spec.gain *= 0.5;
  const Design noisy = judge_coupling(r, spec);
  EXPECT_EQ(noisy.status, DesignStatus::kInfeasible);
  EXPECT_TRUE(has_reason(noisy, DesignLimit::kDampingLimit));
  r.device.translation.resolution = 0.0;
  EXPECT_EQ(judge_coupling(r, spec).status, DesignStatus::kAsRequested);
  spec.injected_damping_ns_per_m = 1.01 * damping_limit(axis_problems(r)[0], velocity_of(spec));
  EXPECT_EQ(judge_coupling(r, spec).status, DesignStatus::kInfeasible);
}

TEST(GivenCoupling, RefusesMoreThanTheDeviceCanDisplay) {
  DesignProblem r = robot(2.0, 5.0, 50.0);
  r.contact.all_points = 400.0, r.device.translation.max_stiffness = 300.0;
  CouplingSpec spec;
  spec.cutoff_hz = 5.0;
  EXPECT_EQ(judge_coupling(r, spec).status, DesignStatus::kInfeasible);
  spec.gain = 0.75;
  EXPECT_EQ(judge_coupling(r, spec).status, DesignStatus::kAsRequested);
}

TEST(GivenCoupling, RefusesInvalidWordsAndNumbers) {
  CouplingSpec spec;
  spec.cutoff_hz = -1.0;
  EXPECT_THROW(judge_coupling(stylus(), spec), std::invalid_argument);
  spec = {};
  spec.kind = "rubber";
  EXPECT_THROW(judge_coupling(stylus(), spec), std::invalid_argument);
}

TEST(AnyPassiveHand, GetsNoInjectedDampingAndRuleP) {
  DesignProblem r = robot(2.0, 5.0, 50.0);
  r.hand.translation.any_passive = true;
  const Design d = designed(r);
  EXPECT_EQ(d.spec.injected_damping_ns_per_m, 0.0);
  EXPECT_TRUE(d.translation.passive);
  EXPECT_LE(2.0 * d.translation.displayed_stiffness,
            passive_stiffness_filter(cutoff_rad_per_s(d.spec), d.spec.damping_ratio, 50.0,
                                     r.device.timing, 3e-3) *
                (1 + 1e-9));
  r.device.translation.damping = 0.005;
  EXPECT_EQ(designed(r).spec.injected_damping_ns_per_m, 0.0);
  EXPECT_EQ(designed(r).status, DesignStatus::kInfeasible);
}

TEST(AnyPassiveHand, IsSatisfiedByTheDampingOfTheDesign) {
  DesignProblem r = stylus();
  r.hand.translation.any_passive = true;
  const double now = designed(r).translation.damping_required,
               any_cutoff = damping_required_any_cutoff(r);
  r.device.translation.damping = 1.001 * now;
  EXPECT_EQ(designed(r).status, DesignStatus::kAsRequested);
  r.device.translation.damping = 0.99 * now;
  EXPECT_NE(designed(r).status, DesignStatus::kAsRequested);
  r.device.translation.damping = 1.001 * any_cutoff;
  EXPECT_EQ(designed(r).status, DesignStatus::kBandwidthRaised);
  r.device.translation.damping = 0.98 * any_cutoff;
  EXPECT_EQ(designed(r).status, DesignStatus::kStiffnessReduced);
}

TEST(AnyPassiveHand, InjectedDampingNeverCertifiesIt) {
  const Design d = designed(stylus());
  EXPECT_GT(d.spec.injected_damping_ns_per_m, 0.0);
  EXPECT_FALSE(d.translation.passive);
  EXPECT_EQ(d.translation.passive_stiffness, 0.0);
}

}  // namespace designer_given_coupling_test
}  // namespace voxtouch::coupling::design
