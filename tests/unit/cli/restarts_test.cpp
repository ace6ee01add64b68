// Figures of a node over all its processes, on synthetic reports.
#include "nodes/cli/up/restarts.hpp"

#include <gtest/gtest.h>

namespace voxtouch::cli {
namespace {

runtime::NodeReport with(runtime::Figures figures) {
  runtime::NodeReport report;
  report.figures = std::move(figures);
  return report;
}

double value(const runtime::NodeReport& report, const char* name) {
  return runtime::value_of(report.figures, name);
}

TEST(Restarts, ReportHowAProcessEnded) {
  EXPECT_EQ(how_ended(137), "signal 9");
  EXPECT_EQ(how_ended(1), "status 1");
}

TEST(Restarts, SumCountsAndKeepTheFirstSampleAndExtremes) {
  const auto earlier = with({{"samples", {100, "samples"}},
                             {"first_sample", {3, "sample number"}},
                             {"disagree", {2, "samples"}},
                             {"written", {50, "messages"}},
                             {"fault_latches", {1, "times"}},
                             {"most_residual_m", {0.5, "m"}},
                             {"stiffness_at_hand_n_per_m", {900, "N/m"}},
                             {"design_gain", {0.4, "1"}}});
  auto now = with({{"samples", {10, "samples"}},
                   {"first_sample", {2500, "sample number"}},
                   {"disagree", {0, "samples"}},
                   {"written", {5, "messages"}},
                   {"most_residual_m", {0.1, "m"}},
                   {"stiffness_at_hand_n_per_m", {100, "N/m"}},
                   {"design_gain", {0.6, "1"}}});
  now.message = "running";
  const auto all = over_all_processes(earlier, now);
  EXPECT_EQ(value(all, "samples"), 110);
  EXPECT_EQ(value(all, "first_sample"), 3);
  EXPECT_EQ(value(all, "disagree"), 2) << "a disagreement is not forgotten";
  EXPECT_EQ(value(all, "written"), 55);
  EXPECT_EQ(value(all, "fault_latches"), 1) << "of the earlier process alone";
  EXPECT_EQ(value(all, "most_residual_m"), 0.5);
  EXPECT_EQ(value(all, "stiffness_at_hand_n_per_m"), 900);
  EXPECT_EQ(value(all, "design_gain"), 0.6) << "as it runs now";
  EXPECT_EQ(all.message, "running");
}

TEST(Restarts, HaveNoFirstSampleWithoutAnAnswer) {
  const auto all = over_all_processes(
      with({{"samples", {0, "samples"}}, {"first_sample", {0, "sample number"}}}),
      with({{"samples", {10, "samples"}}, {"first_sample", {2500, "sample number"}}}));
  EXPECT_EQ(value(all, "first_sample"), 2500);
}

/// A bound is an extreme of one process: the larger one must not excuse the other process's debt.
TEST(Restarts, KeepTheWorseEnergyAccountWithItsOwnBound) {
  const auto account = [](double lowest_j, double bound_j) {
    return with({{"samples", {10, "samples"}},
                 {"lowest_energy_j", {lowest_j, "J"}},
                 {"energy_bound_j", {bound_j, "J"}}});
  };
  for (const bool worse_first : {false, true}) {
    const auto bad = account(-1e-3, 5e-4), large = account(-2e-3, 1e-2);
    const auto all = worse_first ? over_all_processes(bad, large) : over_all_processes(large, bad);
    EXPECT_EQ(value(all, "lowest_energy_j"), -1e-3);
    EXPECT_EQ(value(all, "energy_bound_j"), 5e-4);
  }
}

}  // namespace
}  // namespace voxtouch::cli
