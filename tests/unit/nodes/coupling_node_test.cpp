// The coupling node alone: its designs, the causes of a new design, and refused device properties.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/nodes/around_coupling.hpp"

namespace voxtouch::test::around_coupling {
namespace {

double largest_step(const std::vector<double>& forces) {
  double step = 0.0;
  for (std::size_t i = 1; i < forces.size(); ++i)
    step = std::max(step, std::abs(forces[i] - forces[i - 1]));
  return step;
}

TEST(CouplingNode, WaitsForDeviceAndPlanThenDesignsOnce) {
  Around around("{design: auto, kind: shaping_filter}");
  around.describe(2.0);
  std::this_thread::sleep_for(milliseconds(200));
  around.poll();
  EXPECT_TRUE(around.seen.empty()) << "nothing is known of the contact yet";
  around.plan();
  ASSERT_TRUE(wait_until([&] {
    around.poll();
    return !around.seen.empty();
  }));
  std::this_thread::sleep_for(milliseconds(200));
  around.poll();
  ASSERT_EQ(around.seen.size(), 1U);
  EXPECT_NE(around.seen[0].status, "infeasible");
  EXPECT_EQ(around.seen[0].kind, "shaping_filter");
  EXPECT_GT(around.seen[0].displayed_n_per_m, 50.0);
  for (int i = 0; i < 600; ++i)
    around.touch();
  ASSERT_FALSE(around.forces.empty());
  EXPECT_GT(around.forces.back(), 0.5 * kForce);
  EXPECT_EQ(around.node.end(), 0);
}

TEST(CouplingNode, RedesignsWithoutAForceStep) {
  Around around("{design: auto, kind: shaping_filter}");
  around.describe(20.0);
  around.plan();
  ASSERT_TRUE(wait_until([&] {
    around.poll();
    return around.seen.size() == 1;
  }));
  for (int i = 0; i < 800; ++i)
    around.touch();
  ASSERT_NEAR(around.forces.back(), kForce, 0.02 * kForce) << "nothing to cap yet";
  around.forces.clear();
  around.describe(
      0.05);  // it has lost its damping: less can be shown, and damping must be injected
  for (int i = 0; i < 200 || (around.seen.size() < 2 && i < 5000); ++i)
    around.touch();
  ASSERT_EQ(around.seen.size(), 2U);
  EXPECT_LT(around.seen[1].displayed_n_per_m, around.seen[0].displayed_n_per_m);
  EXPECT_GT(around.seen[1].damping_ns_per_m, 0.0);
  EXPECT_TRUE(around.seen[0].starts_at_rest && around.seen[0].commands_force);
  EXPECT_EQ(around.seen[0].from_sample, 0U);
  EXPECT_TRUE(!around.seen[1].starts_at_rest && around.seen[1].commands_force);
  EXPECT_GE(around.seen[1].from_sample, 800U);
  around.plan(300.0);
  for (int i = 0; i < 600 || (around.seen.size() < 3 && i < 5000); ++i)
    around.touch();
  ASSERT_EQ(around.seen.size(), 3U);
  EXPECT_LT(largest_step(around.forces), 0.05 * kForce)
      << "of a held contact; a jump would be displayed as a knock";
  EXPECT_GT(around.forces.back(), 0.2 * kForce) << "the same contact is still displayed";
  EXPECT_EQ(around.node.end(), 0);
}

TEST(CouplingNode, IsSilentWithoutAFeasibleCoupling) {
  Around around("{design: auto, hand: any_passive}");
  around.describe(0.005);
  around.plan();
  ASSERT_TRUE(wait_until([&] {
    around.poll();
    return !around.seen.empty();
  }));
  EXPECT_EQ(around.seen[0].status, "infeasible");
  EXPECT_GT(around.seen[0].reasons, 0U);
  for (int i = 0; i < 200; ++i)
    around.touch();
  EXPECT_TRUE(around.forces.empty());
  EXPECT_TRUE(wait_until([&] {
    return around.message().find("run_infeasible") != std::string::npos;
  })) << around.message();
  EXPECT_EQ(around.node.end(), 0);
}

TEST(CouplingNode, RunsAnInfeasibleDesignIfTheSceneAllows) {
  Around around("{design: auto, hand: any_passive, run_infeasible: true}");
  around.describe(0.005);
  around.plan();
  ASSERT_TRUE(wait_until([&] {
    around.poll();
    return !around.seen.empty();
  }));
  EXPECT_EQ(around.seen[0].status, "infeasible");
  for (int i = 0; i < 200; ++i)
    around.touch();
  EXPECT_FALSE(around.forces.empty());
  EXPECT_EQ(around.node.end(), 0);
}

TEST(CouplingNode, StopsIfAChangedDeviceLeavesNoDesign) {
  Around around("{design: auto, hand: any_passive}");
  around.describe(20.0);
  around.plan();
  ASSERT_TRUE(wait_until([&] {
    around.poll();
    return !around.seen.empty();
  }));
  for (int i = 0; i < 100; ++i)
    around.touch();
  ASSERT_FALSE(around.forces.empty());
  around.describe(0.005);
  ASSERT_TRUE(wait_until([&] {
    around.touch();
    return around.seen.size() == 2;
  }));
  EXPECT_EQ(around.seen[1].status, "infeasible");
  for (int i = 0; i < 20; ++i)
    around.touch();
  around.forces.clear();
  for (int i = 0; i < 100; ++i)
    around.touch();
  EXPECT_TRUE(around.forces.empty());
  EXPECT_EQ(around.node.end(), 0);
}

TEST(CouplingNode, EvaluatesAndRunsAManualCoupling) {
  Around around(
      "{kind: shaping_filter, cutoff_hz: 5, damping_ratio: 1, gain: 1}");  // the paper's recipe
  around.describe(0.005);
  around.plan(3.0);
  ASSERT_TRUE(wait_until([&] {
    around.poll();
    return !around.seen.empty();
  }));
  EXPECT_EQ(around.seen[0].status, "configured");
  EXPECT_EQ(around.seen[0].cutoff_hz, 5.0);
  EXPECT_GT(around.seen[0].reasons, 0U)
      << "300 N/m through a 5 Hz filter are not stable on this device";
  for (int i = 0; i < 600; ++i)
    around.touch();
  ASSERT_FALSE(around.forces.empty());
  EXPECT_NEAR(around.forces.back(), kForce, 0.1 * kForce);
  EXPECT_EQ(around.node.end(), 0);
}

TEST(CouplingNode, RefusesInvalidDevicesAndKeepsItsDesign) {
  Around around("{design: auto, kind: shaping_filter}");
  around.describe(20.0);
  around.plan();
  ASSERT_TRUE(wait_until([&] {
    around.poll();
    return around.seen.size() == 1;
  }));
  for (int i = 0; i < 300; ++i)
    around.touch();
  for (const double impossible : {std::nan(""), -1.0, 1e9}) {
    around.describe(impossible);
    ASSERT_TRUE(wait_until([&] {
      around.touch();
      return around.message().find("damping_ns_per_m") != std::string::npos;
    })) << around.message();
    const std::size_t designs = around.seen.size();
    around.forces.clear();
    for (int i = 0; i < 200; ++i)
      around.touch();
    EXPECT_EQ(around.seen.size(), designs) << "it designs for a device that cannot be";
    EXPECT_FALSE(around.forces.empty());
    around.describe(20.0);
    ASSERT_TRUE(wait_until(
        [&] {  // and the design for it, which takes its time, is made before the next refusal
          around.touch();
          return around.message().find("damping_ns_per_m") == std::string::npos &&
                 around.seen.size() > designs;
        }))
        << around.message();
  }
  around.forces.clear();
  for (int i = 0; i < 300; ++i)
    around.touch();
  ASSERT_FALSE(around.forces.empty());
  EXPECT_NEAR(around.forces.back(), kForce, 0.1 * kForce);
  EXPECT_EQ(around.node.end(), 0);
}

}  // namespace
}  // namespace voxtouch::test::around_coupling
