#include "nodes/cli/up/start_report.hpp"
#include "nodes/cli/force_line.hpp"

#include <gtest/gtest.h>

namespace voxtouch::cli {
namespace start_report_test {

TEST(StartWarnings, PrintTwoAndCountTheRest) {
  EXPECT_TRUE(limited_warnings({}, "cup").empty());
  EXPECT_EQ(limited_warnings({"a", "b"}, "cup"),
            (std::vector<std::string>{"warning: a", "warning: b"}));
  const std::vector<std::string> few = limited_warnings({"a", "b", "c", "d"}, "cup");
  ASSERT_EQ(few.size(), 3U);
  EXPECT_EQ(few[1], "warning: b");
  for (const char* fact : {" 2 ", "`voxtouch plan cup`", "`voxtouch doctor`"})
    EXPECT_TRUE(few[2].contains(fact)) << few[2];
}

TEST(StartWarnings, ReportMachineWarningsInOneSentence) {
  runtime::RealtimeOptions options;
  options.cpu = 100'000;  // no machine has it
  const std::vector<std::string> reported = warnings_of_machine(options);
  ASSERT_EQ(reported.size(), 1U);
  EXPECT_TRUE(reported[0].contains("see `voxtouch doctor`")) << reported[0];
}

TEST(StartReport, PrintsWarningsAndPreviewOnce) {
  StartReport start({"of the file", "of both"}, "cup", "stylus");
  Reports reports;
  EXPECT_TRUE(start.poll(reports).empty());
  reports["rendering"].state = runtime::NodeState::kStarting;
  EXPECT_TRUE(start.poll(reports).empty()) << "it builds";
  reports["rendering"].figures["warnings"] = {1.0, "warnings"};
  reports["rendering"].values["plan_warning_1"] = "of both";
  EXPECT_EQ(start.poll(reports),
            (std::vector<std::string>{"warning: of both", "warning: of the file"}));
  EXPECT_TRUE(start.poll(reports).empty());
  reports["coupling"].values["stiffness_limit"] = "device";
  reports["coupling"].figures = {{"certified_stiffness_n_per_m", {800.0, "N/m"}},
                                 {"design_gain_margin", {2.0, "1"}},
                                 {"saturation_force_n", {8.0, "N"}},
                                 {"saturation_depth_m", {0.01, "m"}}};
  const std::vector<std::string> lines = start.poll(reports);
  ASSERT_EQ(lines.size(), 1U);
  for (const char* fact :
       {"800 N/m", "margin 2", "stylus", "8 N", "10 mm", "largest stable stiffness"})
    EXPECT_TRUE(lines[0].contains(fact)) << lines[0];
  EXPECT_TRUE(start.poll(reports).empty());
}

TEST(ForceLine, HasTheStiffnessAtALongToolsReachAndALimitedGrip) {
  device_fit::ForcePreview p{
      .stiffness_n_per_m = 518.0, .gain_margin = 2.0, .force_n = 8.5, .depth_m = 0.0164};
  EXPECT_EQ(contact_line(p, "stylus"), "");
  p.reach_m = 0.15, p.rotation_nm_per_rad = 518.0 * 0.15 * 0.15;
  for (const char* fact : {"150 mm", "518 N/m along", "259 N/m across"})
    EXPECT_TRUE(contact_line(p, "stylus").contains(fact)) << contact_line(p, "stylus");
  p.grip_n_per_m = 5000.0;
  EXPECT_TRUE(force_lines(p, "stylus")
                  .at(1)
                  .contains("grip stiffness of 5000 N/m is limited to the certified 518 N/m"));
}

}  // namespace start_report_test
}  // namespace voxtouch::cli
