/// The contacts that a design is certified for.
#include "core/coupling/design/absolute_stability.hpp"

#include <gtest/gtest.h>

#include "core/coupling/design/axis_verdict.hpp"
#include "tests/support/coupling_models/population.hpp"
#include "tests/unit/coupling_design/designer_support.hpp"

namespace voxtouch::testing {
namespace {

using namespace coupling;
using namespace coupling::design;

DesignProblem as_scenes_ask(DesignProblem request) {
  request.goals = {};
  request.goals.free_cap = true;
  return request;
}

bool has(const ContactCertificate& c, CertificateGap gap) {
  return std::ranges::find(c.gaps, gap) != c.gaps.end();
}

/// Every case of each axis, translation on both velocities.
std::size_t expected_loops(const DesignProblem& request, const CouplingSpec& spec) {
  const std::vector<AxisProblem> axes = axis_problems(request);
  std::size_t loops = axes[0].cases.size() * (damps_on_slow_velocity(spec) ? 2 : 1);
  if (axes.size() > 1)
    loops += axes[1].cases.size();
  return loops;
}

TEST(AbsoluteStability, CertifiesAStylusForAnyContact) {
  const DesignProblem request = as_scenes_ask(sim_stylus());
  const Design design = design_coupling(request);
  const ContactCertificate c = certify_contacts(request, design);
  EXPECT_EQ(c.contact, ContactClass::kMonotone);
  EXPECT_EQ(c.proof, MonotoneProof::kMultiplier);
  EXPECT_GE(c.ratio_of_linear, 0.98);
  ASSERT_EQ(c.axes.size(), 1U);
  EXPECT_GE(c.axes[0].margin, 1.5);
  EXPECT_NEAR(c.axes[0].margin * design.translation.displayed_stiffness, c.axes[0].stiffness,
              1e-9 * c.axes[0].stiffness);
  EXPECT_TRUE(
      prove(c.multiplier, contact_loops(request, design.spec, std::array{c.axes[0].stiffness}))
          .holds());
}

TEST(AbsoluteStability, OneMultiplierServesTranslationAndRotation) {
  DesignProblem request = as_scenes_ask(sim_arm());
  request.device.gives_torque = true;
  request.device.rotation = {.inertia_min = 0.02,
                             .inertia_max = 0.05,
                             .damping = 0.5,
                             .resolution = 1e-4,
                             .max_effort = 10.0,
                             .max_stiffness = 100.0};
  request.hand.rotation = kWrist;
  request.contact_rotation = {1.0, 100.0};
  const Design design = design_coupling(request);
  ASSERT_NE(design.status, DesignStatus::kInfeasible);
  const ContactCertificate c = certify_contacts(request, design);
  EXPECT_EQ(c.contact, ContactClass::kMonotone);
  ASSERT_EQ(c.axes.size(), 2U);
  EXPECT_GE(std::min(c.axes[0].margin, c.axes[1].margin), 1.0);
  const std::array stiffness{c.axes[0].stiffness, c.axes[1].stiffness};
  const std::vector<ContactLoop> loops = contact_loops(request, design.spec, stiffness);
  EXPECT_EQ(static_cast<int>(loops.size()), c.loops);
  EXPECT_EQ(loops.size(), expected_loops(request, design.spec));
  EXPECT_TRUE(prove(c.multiplier, loops).holds());
  EXPECT_FALSE(has(c, CertificateGap::kForceOnlyLever));
}

TEST(AbsoluteStability, CertifiesOnTheSlowVelocityToo) {
  DesignProblem request = sim_arm();
  request.goals = {};
  request.goals.force_layer_depth_m = 0.004;
  const Design design = design_coupling(request);
  ASSERT_TRUE(damps_on_slow_velocity(design.spec));
  const ContactCertificate c = certify_contacts(request, design);
  EXPECT_EQ(static_cast<std::size_t>(c.loops), expected_loops(request, design.spec));
  EXPECT_TRUE(has(c, CertificateGap::kVelocityBand));
  CouplingSpec fast = design.spec;
  fast.slow_velocity_hz = fast.velocity_band_m_per_s = 0.0;
  EXPECT_LT(linear_limits(request, design.spec)[0], linear_limits(request, fast)[0]);
}

/// Every case at its own limit: nothing above it is certified, and 0.99 of it is.
TEST(AbsoluteStability, ReachesTheLinearLimitOfEachCaseAndNoMore) {
  int cases = 0, reached = 0;
  for (std::uint64_t i = 0; i < 12; ++i) {
    const coupling_models::PopulationMember member = coupling_models::draw_member(5, i);
    if (member.hand.any_passive)
      continue;
    DesignProblem request;
    request.device = member.device;
    request.hand.translation = member.hand;
    request.contact = member.contact;
    request.goals.free_cap = true;
    const Design design = design_coupling(request);
    if (design.status == DesignStatus::kInfeasible || design.spec.kind == "spring_damper")
      continue;
    const AxisProblem axis = axis_problems(request).front();
    const LoopController law = controller_of(design.spec, axis, 0.0);
    for (const DesignCase& one : axis.cases) {
      const double limit = critical_stiffness(one.plant, law).stiffness;
      const auto certified = [&](double ratio) {
        const double k = ratio * limit;
        return find_multiplier(std::array{ContactLoop{loop_over_arc(one.plant, law), 1.0 / k,
                                                      kMultiplierFloor / k}})
            .has_value();
      };
      ++cases;
      reached += certified(0.99);
      for (const double ratio : {1.0005, 1.01, 1.1, 3.0, 100.0})
        EXPECT_FALSE(certified(ratio)) << i << " " << ratio;
    }
  }
  EXPECT_GE(cases, 150);
  EXPECT_GE(reached, 0.98 * cases) << "of " << cases;
}

/// Unbounded dampers, so that the linear certificate covers the same loops.
TEST(AbsoluteStability, StaysBelowTheFirstUnstableLoop) {
  const DesignProblem request = as_scenes_ask(sim_stylus());
  const Design design = design_coupling(request);
  const ContactCertificate c = certify_contacts(request, design);
  EXPECT_LT(c.axes[0].stiffness, linear_limits(request, design.spec)[0]);
}

TEST(AbsoluteStability, DesignAtItsLinearLimitIsLinearOnly) {
  DesignProblem request = stylus();
  request.goals.gain_margin = 1.0;
  request.goals.free_cap = true;
  CouplingSpec spec;
  spec.kind = "direct";
  spec.injected_damping_ns_per_m = 2.0;
  spec.damping_force_ratio = 0.0;
  spec.velocity_filter_hz = 100.0;
  request.contact.all_points = 0.999 * linear_limits(request, spec)[0];
  request.contact.one_point = 0.1 * request.contact.all_points;
  const Design design = judge_coupling(request, spec);
  ASSERT_NE(design.status, DesignStatus::kInfeasible);
  const ContactCertificate c = certify_contacts(request, design);
  EXPECT_EQ(c.contact, ContactClass::kLinear);
  EXPECT_EQ(c.proof, MonotoneProof::kNone);
  EXPECT_LT(c.axes[0].margin, 1.0);
  EXPECT_GT(c.axes[0].margin, 0.9);
}

TEST(AbsoluteStability, AnyPassiveHandRestsOnItsOwnRule) {
  DesignProblem request = robot(5.0, 5.0, 50.0);
  request.hand.translation.any_passive = true;
  request.goals.allow_injected_damping = false;
  const Design design = design_coupling(request);
  ASSERT_NE(design.status, DesignStatus::kInfeasible);
  const ContactCertificate c = certify_contacts(request, design);
  EXPECT_EQ(c.contact, ContactClass::kMonotone);
  EXPECT_EQ(c.proof, MonotoneProof::kPassivity);
  EXPECT_EQ(c.loops, 0);
  EXPECT_NEAR(c.axes[0].stiffness, design.translation.passive_stiffness, 1e-12);
  EXPECT_FALSE(has(c, CertificateGap::kVaryingTiming));
}

TEST(AbsoluteStability, SpringDamperBearsAnyContactStiffness) {
  DesignProblem request = as_scenes_ask(robot(2.0, 5.0, 50.0));
  request.goals.kind = "spring_damper";
  const Design design = design_coupling(request);
  ASSERT_EQ(design.spec.kind, "spring_damper");
  ASSERT_NE(design.status, DesignStatus::kInfeasible);
  const ContactCertificate c = certify_contacts(request, design);
  EXPECT_EQ(c.contact, ContactClass::kMonotone);
  EXPECT_GE(c.axes[0].margin, 1.0);
}

TEST(AbsoluteStability, AnInfeasibleDesignHasNone) {
  const ContactCertificate c = certify_contacts(stylus(), Design{});
  EXPECT_EQ(c.contact, ContactClass::kNone);
  EXPECT_TRUE(c.gaps.empty());
}

TEST(AbsoluteStability, NamesSkippedCases) {
  const DesignProblem request = as_scenes_ask(sim_stylus());
  Design design = design_coupling(request);
  ASSERT_GT(design.spec.injected_damping_ns_per_m, 0.0);
  ContactCertificate c = certify_contacts(request, design);
  EXPECT_TRUE(has(c, CertificateGap::kDamperGate));
  EXPECT_EQ(has(c, CertificateGap::kDamperBound), design.spec.damping_force_ratio > 0.0);
  EXPECT_TRUE(has(c, CertificateGap::kVaryingTiming));
  EXPECT_TRUE(has(c, CertificateGap::kForceOnlyLever));
  EXPECT_TRUE(has(c, CertificateGap::kCurvedContact));
  EXPECT_TRUE(has(c, CertificateGap::kVoxelSteps));
  EXPECT_FALSE(has(c, CertificateGap::kReleasedFrictionless));
  design.spec.injected_damping_ns_per_m = 0.0;
  design.spec.gain = 1e-3;
  design.translation.displayed_stiffness = 1e-3;
  c = certify_contacts(request, design);
  EXPECT_FALSE(has(c, CertificateGap::kDamperGate));
  EXPECT_FALSE(has(c, CertificateGap::kDamperBound));
}

TEST(AbsoluteStability, IsReproducible) {
  const DesignProblem request = as_scenes_ask(sim_stylus());
  const Design design = design_coupling(request);
  const ContactCertificate a = certify_contacts(request, design),
                           b = certify_contacts(request, design);
  EXPECT_EQ(a.axes[0].stiffness, b.axes[0].stiffness);
  EXPECT_EQ(a.multiplier.past, b.multiplier.past);
  EXPECT_EQ(a.multiplier.at_rest, b.multiplier.at_rest);
}

}  // namespace
}  // namespace voxtouch::testing
