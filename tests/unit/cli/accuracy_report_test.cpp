/// Output of `voxtouch accuracy`: text, JSON and CSV.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <sstream>

#include <nlohmann/json.hpp>

#include "tests/unit/cli/accuracy_support.hpp"

namespace voxtouch::cli {
namespace {

using test::accuracy_report;

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);)
    out.push_back(line);
  return out;
}

/// Lines of the table that start with marks, weights and e.
std::vector<std::string> rows_of(const std::string& text) {
  std::vector<std::string> out;
  for (const std::string& line : lines(text))
    if (line.size() > 12 && (line.substr(5, 4) == "one " || line.substr(5, 5) == "area "))
      out.push_back(line);
  return out;
}

TEST(AccuracyText, GroupsByModelAndMarksFrontAndAdvice) {
  const std::string text = to_text(accuracy_report());
  const auto rows = rows_of(text);
  ASSERT_EQ(rows.size(), 6u) << text;
  EXPECT_EQ(rows[0].substr(0, 5), "  *  ");
  EXPECT_EQ(rows[1].substr(0, 5), "     ");
  EXPECT_EQ(rows[2].substr(0, 5), "  *> ");
  EXPECT_EQ(rows[3].substr(0, 5), "  *  ");
  std::size_t groups = 0;
  for (const std::string& line : lines(text))
    groups += line == "  original" || line == "  adapted" || line == "  field";
  EXPECT_EQ(groups, 3u);
}

TEST(AccuracyText, AlignsItsColumnsUnderTheirHeads) {
  const auto all = lines(to_text(accuracy_report()));
  const auto rows = rows_of(to_text(accuracy_report()));
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(rows[i].size(), rows[0].size()) << rows[i];
  const auto units = std::find_if(
      all.begin(), all.end(), [](const auto& l) { return l.find("[MB]") != std::string::npos; });
  ASSERT_NE(units, all.end());
  EXPECT_EQ(units->size(), rows[0].size()) << *units << "\n" << rows[0];
  for (const char* head : {"mean", "median", "p95", "/true", "[%]", "worst", "[MB]"}) {
    const std::size_t end = units->find(head) + std::string(head).size();
    EXPECT_TRUE(std::isdigit(static_cast<unsigned char>(rows[0][end - 1]))) << head;
    EXPECT_TRUE(end == rows[0].size() || rows[0][end] == ' ') << head;
  }
}

TEST(AccuracyText, KeepsItsColumnsForFiguresOfAnySize) {
  AccuracyReport report = accuracy_report();
  report.rows[0].worst_us = 123456.0, report.rows[0].direction_median_deg = 179.99,
  report.rows[1].onset_worst_m = -0.0123;
  report.rows[1].torque_error_m = 1e-12,
  report.rows[3].magnitude_noise = std::numeric_limits<double>::quiet_NaN();
  const auto rows = rows_of(to_text(report));
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(rows[i].size(), rows[2].size()) << rows[i];
  EXPECT_EQ(rows[1].find("e-"), std::string::npos);
}

TEST(AccuracyText, PrintsMissesAndTheSpreadOverDepthAndGrid) {
  const std::string text = to_text(accuracy_report());
  const auto rows = rows_of(text);
  EXPECT_TRUE(rows[0].contains(" 50 ")) << "contacts judged: found and missed\n" << rows[0];
  EXPECT_TRUE(rows[0].contains(" 20.0 ")) << "10 of 50 missed, in %\n" << rows[0];
  for (const char* figure : {"original/one, e = 4 mm", "0.875", "0.125", "45.0", "10.0 to 50.0",
                             "2.00 to 90.0", "0.500 to 1.50", "5.60 to 7.20"})
    EXPECT_TRUE(text.contains(figure)) << figure << " in\n" << text;
}

TEST(AccuracyText, PrintsRefusedAndUntouchedRowsAsSuch) {
  const AccuracyReport report = accuracy_report();
  const auto rows = rows_of(to_text(report));
  EXPECT_TRUE(rows[4].ends_with(report.rows[4].refused)) << rows[4];
  EXPECT_EQ(rows[5].find_first_of("0123456789", rows[5].rfind("500") + 3), std::string::npos)
      << "zeros would look like perfection\n"
      << rows[5];
}

TEST(AccuracyText, PrintsTheConditions) {
  const AccuracyReport report = accuracy_report({.direction_deg = 1.0});
  const std::string text = to_text(report);
  for (const char* fact : {"cup & saucer", "seed 7", "40 contacts", "0.5 e", "Some(R) CPU",
                           "2 CPUs", "0.5 before", "1.5 after", "gcc 12", "-O3"})
    EXPECT_TRUE(text.contains(fact)) << fact << " in\n" << text;
}

/// The line above the table.
std::string chosen(const AccuracyReport& report) {
  const std::vector<std::string> all = lines(to_text(report));
  const auto last = std::ranges::find_if(
      all, [](const std::string& line) { return line.starts_with("  Chosen: "); });
  return last == all.end() ? "" : last->substr(10);
}

TEST(AccuracyText, NamesTheChosenSettingInOneLine) {
  EXPECT_EQ(chosen(accuracy_report()),
            "field/area, e = 4 mm, 10.0 us a frame, direction error 0.500 deg, the knee of the "
            "Pareto front");
  EXPECT_EQ(
      chosen(accuracy_report({.direction_deg = 0.1})),
      "field/area, e = 1 mm, 90.0 us a frame, direction error 0.050 deg, which meets the limit");
  EXPECT_EQ(chosen(accuracy_report({.within_us = 4})),
            "original/one, e = 4 mm, 5.00 us a frame, direction error 8.00 deg, the closest to the "
            "limit (no setting meets it)");
}

TEST(AccuracyText, BeginsWithTheChosenSetting) {
  const std::string text = to_text(accuracy_report());
  EXPECT_TRUE(text.starts_with("\n  Chosen: field/area, e = 4 mm")) << text;
}

TEST(AccuracyText, PrintsWhyNoSettingIsChosen) {
  AccuracyReport report = accuracy_report();
  report.rows[4].setting.virtual_tool = true;
  report.advice = accuracy::advise(report.rows, {}, true);
  EXPECT_EQ(chosen(report),
            "none; the scene's virtual tool was refused: " + report.rows[4].refused);
  report.rows = {report.rows[0], report.rows[3]};
  report.advice = accuracy::advise(report.rows, {});
  EXPECT_EQ(chosen(report), "none; the Pareto front has no knee");
  report.rows.pop_back();
  report.advice = accuracy::advise(report.rows, {});
  EXPECT_TRUE(chosen(report).ends_with(", the fastest and the most accurate")) << chosen(report);
  report.rows[0].magnitude_noise = std::numeric_limits<double>::quiet_NaN();
  report.advice = accuracy::advise(report.rows, {.noise = 0.1});
  EXPECT_EQ(chosen(report), "none; no setting has the limited figure");
  report.rows[0].contacts = 0;
  report.advice = accuracy::advise(report.rows, {});
  EXPECT_EQ(chosen(report), "none; all 1 settings were refused or have no contact");
}

TEST(AccuracyText, PrintsWhichVirtualToolFramesWereTimed) {
  AccuracyReport report = accuracy_report();
  EXPECT_FALSE(to_text(report).contains("queries"));
  report.rows[3].setting.virtual_tool = true, report.rows[3].queries_per_frame = 1.75;
  EXPECT_TRUE(to_text(report).contains("slides 0.025 e a frame sideways, 5 e deep; 1.75 queries"))
      << to_text(report);
  EXPECT_EQ(nlohmann::json::parse(to_json(report).dump())["rows"][3]["queries_per_frame"], 1.75);
}

TEST(AccuracyJson, HoldsRowsOptionsConditionsAndAdvice) {
  const AccuracyReport report = accuracy_report({.noise = 0.03});
  const nlohmann::json j = nlohmann::json::parse(to_json(report).dump());
  EXPECT_EQ(j["ok"], true);
  EXPECT_EQ(j["options"], nlohmann::json({{"seed", 7}, {"contacts", 40}, {"depth_edges", 0.5}}));
  EXPECT_EQ(j["request"]["noise"], 0.03);
  EXPECT_TRUE(j["request"]["within_us"].is_null());
  EXPECT_EQ(j["conditions"]["processor"], "Some(R) CPU");
  EXPECT_EQ(j["conditions"]["load_after"], 1.5);
  EXPECT_EQ(j["conditions"]["flags"], "-O3");
  ASSERT_EQ(j["rows"].size(), 6u);
  EXPECT_EQ(j["rows"][2]["model"], "field");
  EXPECT_EQ(j["rows"][2]["weights"], "area");
  EXPECT_EQ(j["rows"][2]["voxel_m"], 0.004);
  EXPECT_EQ(j["rows"][2]["direction_mean_deg"], 0.5);
  EXPECT_EQ(j["rows"][2]["direction_median_deg"], 0.4);
  EXPECT_EQ(j["rows"][2]["missed"], 10);
  EXPECT_EQ(j["rows"][2]["missed_ratio"], 0.2);
  EXPECT_EQ(j["rows"][2]["depths"][1]["force_ratio"], 0.125);
  EXPECT_EQ(j["rows"][2]["phases"]["missed_ratio"], nlohmann::json({0.1, 0.5}));
  EXPECT_EQ(j["rows"][2]["median_interval_95"]["direction_median_deg"],
            nlohmann::json({0.7 * 0.5, 0.9 * 0.5}));
  EXPECT_TRUE(j["rows"][2]["median_interval_95"]["median_us"][0].is_null());
  EXPECT_EQ(j["rows"][2]["onset_error_m"], -2e-4);
  EXPECT_EQ(j["rows"][2]["pareto"], true);
  EXPECT_EQ(j["rows"][2]["recommended"], true);
  EXPECT_EQ(j["rows"][1]["pareto"], false);
  EXPECT_EQ(j["advice"]["row"], 2);
  EXPECT_EQ(j["advice"]["met"], true);
  EXPECT_EQ(j["advice"]["front"], nlohmann::json({0, 2, 3}));
  EXPECT_TRUE(j["advice"]["sentence"].get<std::string>().starts_with("field/area, e = 4 mm, "))
      << j["advice"]["sentence"];
}

TEST(AccuracyJson, RowsHaveEqualKeysAndNoUnmeasuredFigure) {
  AccuracyReport report = accuracy_report();
  report.rows[1].torque_error_m = std::numeric_limits<double>::quiet_NaN();
  const nlohmann::ordered_json rows = to_json(report)["rows"];
  for (const auto& row : rows) {
    ASSERT_EQ(row.size(), rows[0].size());
    for (const auto& [key, value] : rows[0].items())
      EXPECT_TRUE(row.contains(key)) << key;
  }
  EXPECT_TRUE(rows[1]["torque_error_m"].is_null());
  EXPECT_EQ(rows[4]["refused"], report.rows[4].refused);
  EXPECT_TRUE(rows[4]["direction_median_deg"].is_null());
  EXPECT_TRUE(rows[4]["bytes"].is_null());
  EXPECT_TRUE(rows[5]["refused"].is_null());
  EXPECT_TRUE(rows[5]["direction_median_deg"].is_null());
  EXPECT_EQ(rows[5]["shell_points"], 8);
}

TEST(AccuracyJson, IsNotOkIfTheGoalIsUnmetOrUnmeasured) {
  EXPECT_EQ(to_json(accuracy_report({.direction_deg = 1e-3}))["ok"], false);
  AccuracyReport none = accuracy_report();
  none.rows = {none.rows[4]};
  none.advice = accuracy::advise(none.rows, {});
  EXPECT_EQ(to_json(none)["ok"], false);
  EXPECT_TRUE(to_json(none)["advice"]["row"].is_null());
}

TEST(AccuracyCsv, HasAHeaderAndACellForEveryColumnAndQuotesReasons) {
  const auto all = lines(to_csv(accuracy_report()));
  ASSERT_EQ(all.size(), 7u);
  const auto commas = [](const std::string& line) {
    return std::count(line.begin(), line.end(), ',');
  };
  EXPECT_TRUE(all[0].starts_with("model,weights,voxel_m,")) << all[0];
  for (std::size_t i : {1u, 2u, 3u, 4u, 6u})
    EXPECT_EQ(commas(all[i]), commas(all[0])) << all[i];
  EXPECT_EQ(all[1],
            "original,one,0.004,0.004,1300,300000,40,10,0.2,8,6.4,16,0.9,0.4,0.0001,-0.0002,0.0005,"
            "5,10,15,1,0.25,5.6,7.2,,,,,,,"
            "0,3,0.875,0,10,45,0.125,0,4,0.1,0.5,2,90,0.5,1.5,1,0,");
  EXPECT_NE(all[0].find(",missed_at_4_e,direction_mean_deg_at_4_e,force_ratio_at_4_e,"),
            std::string::npos)
      << all[0];
  EXPECT_TRUE(all[3].ends_with(",1,1,")) << all[3];
  EXPECT_TRUE(all[5].starts_with("field,area,0.0001,0.0001,,,0,0,,,")) << all[5];
  EXPECT_TRUE(all[5].ends_with(",0,0,\"it would need 80 GB, \"\"too much\"\" <here>\"")) << all[5];
}

}  // namespace
}  // namespace voxtouch::cli
