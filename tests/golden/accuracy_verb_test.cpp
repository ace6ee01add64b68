/// `voxtouch accuracy` from the command line: table, JSON and CSV of a small scene, and refusals.
/// Pictures: plot_test.py.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/golden/golden.hpp"

namespace voxtouch::test {
namespace {

const std::string kPlane = std::string(VOXTOUCH_DEPLOY) + "/scenes/tilted_plane.yaml";

/// A run of seconds: two sizes, few contacts.
std::vector<std::string> small_run(std::vector<std::string> more) {
  std::vector<std::string> all{"accuracy",    kPlane,       "--voxel-sizes",
                               "0.004,0.002", "--contacts", "12"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

nlohmann::json small_json(std::vector<std::string> more) {
  more.push_back("--json");
  const Finished run = voxtouch(small_run(more));
  EXPECT_EQ(run.status, 0) << run.err;
  return nlohmann::json::parse(run.out);
}

TEST(AccuracyVerb, MeasuresEveryRequestedSetting) {
  const TemporaryFolder folder;
  const Finished run =
      voxtouch(small_run({"--json", "--csv", (folder / "a.csv").string(), "--seed", "5"}));
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find(" settings, 12 contacts each"), std::string::npos)
      << "nothing said on standard error";
  const nlohmann::json j = nlohmann::json::parse(run.out);  // stdout is the object and nothing else
  EXPECT_EQ(j["ok"], true);
  EXPECT_EQ(j["options"]["seed"], 5);
  EXPECT_EQ(j["options"]["contacts"], 12);
  EXPECT_FALSE(j["conditions"]["processor"].get<std::string>().empty());
  EXPECT_NE(j["conditions"]["flags"].get<std::string>().find("-ffp-contract=off"),
            std::string::npos);
  ASSERT_EQ(j["rows"].size(), 12u);
  for (const auto& row : j["rows"]) {
    SCOPED_TRACE(row.dump());
    ASSERT_TRUE(row["refused"].is_null());
    EXPECT_GT(row["contacts"], 0);
    EXPECT_LE(row["contacts"], 12);
    EXPECT_GT(row["shell_points"], 0);
    EXPECT_GT(row["bytes"], 0);
    EXPECT_LE(row["missed"].get<double>() + row["contacts"].get<double>(), 12);
    EXPECT_GE(row["direction_mean_deg"], 0.0);
    EXPECT_EQ(row["depths"].size(), 5u);
    EXPECT_EQ(row["phases"]["phases"], 4);
    EXPECT_LE(row["direction_median_deg"], row["direction_p95_deg"]);
    EXPECT_LE(row["direction_p95_deg"], 180.0);
    EXPECT_GE(row["magnitude_noise"], 0.0);
    EXPECT_GT(row["median_us"], 0.0);
    EXPECT_LE(row["median_us"], row["p95_us"]);
    EXPECT_LE(row["p95_us"], row["worst_us"]);
    EXPECT_GE(row["queries_per_frame"], 0.5);
    EXPECT_GT(row["build_s"], 0.0);
  }
  EXPECT_EQ(j["rows"][0]["model"], "original");
  EXPECT_EQ(j["rows"][9]["model"], "field");
  EXPECT_EQ(j["rows"][10]["model"], "virtual_tool");
  const Table csv = Table::read(folder / "a.csv");
  ASSERT_EQ(csv.size(), 12u);
  for (std::size_t i = 0; i < csv.size(); ++i) {
    EXPECT_EQ(csv.text(i, "model"), j["rows"][i]["model"]);
    for (const char* key : {"voxel_m",
                            "shell_voxel_m",
                            "shell_points",
                            "bytes",
                            "contacts",
                            "missed",
                            "missed_ratio",
                            "direction_mean_deg",
                            "direction_median_deg",
                            "force_ratio",
                            "direction_p95_deg",
                            "magnitude_noise",
                            "torque_error_m",
                            "onset_error_m",
                            "onset_worst_m",
                            "median_us",
                            "p95_us",
                            "worst_us",
                            "queries_per_frame",
                            "build_s"})
      if (const nlohmann::json& value = j["rows"][i][key]; !value.is_null()) {
        EXPECT_EQ(csv.number(i, key), value.get<double>()) << key;
      } else {
        EXPECT_TRUE(csv.text(i, "model") == "virtual_tool" &&
                    std::string(key).starts_with("onset_"))
            << key << " of " << i;
      }
  }
}

TEST(AccuracyVerb, ErrorsDependOnTheSeedOnly) {
  const auto errors = [](const char* seed) {
    std::vector<nlohmann::json> out;
    const nlohmann::json j = small_json({"--models", "adapted", "--seed", seed});
    for (const auto& row : j["rows"])
      out.push_back({row["direction_median_deg"], row["direction_p95_deg"], row["magnitude_noise"],
                     row["onset_error_m"], row["torque_error_m"], row["bytes"]});
    return out;
  };
  EXPECT_EQ(errors("3").size(), 4u);
  EXPECT_EQ(errors("3"), errors("3"));
  EXPECT_NE(errors("3"), errors("4"));
}

TEST(AccuracyVerb, PrintsATableAndTheChosenSetting) {
  const Finished run =
      voxtouch(small_run({"--models", "adapted,field", "--want-direction-deg", "90"}));
  ASSERT_EQ(run.status, 0) << run.err;
  for (const char* word : {"direction [deg]", "time [us]", "  adapted\n", "  field\n", "*> ",
                           "CPU time", "  Chosen: "})
    EXPECT_NE(run.out.find(word), std::string::npos) << word << " in\n" << run.out;
}

TEST(AccuracyVerb, PrintsTheNearestAndExitsWithOneIfNoneMeets) {
  const Finished run = voxtouch(small_run({"--models", "original", "--within-us", "0.001"}));
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.out.find("original/"), std::string::npos) << run.out;
  EXPECT_EQ(run.err.find("error:"), std::string::npos) << run.err;
}

TEST(AccuracyVerb, PrintsARefusedSettingWithItsReason) {
  const Finished run = voxtouch({"accuracy", kPlane, "--models", "adapted", "--weights", "one",
                                 "--voxel-sizes", "0.004,1e-7", "--contacts", "8", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const nlohmann::json rows = nlohmann::json::parse(run.out)["rows"];
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_TRUE(rows[0]["refused"].is_null());
  ASSERT_TRUE(rows[1]["refused"].is_string()) << rows[1].dump();
  EXPECT_GT(rows[1]["refused"].get<std::string>().size(), 10u);
  EXPECT_TRUE(rows[1]["direction_median_deg"].is_null());
}

void expect_refused(const std::vector<std::string>& more, const std::string& says) {
  std::vector<std::string> all{"accuracy", kPlane};
  all.insert(all.end(), more.begin(), more.end());
  const Finished run = voxtouch(all);
  std::string call;
  for (const std::string& word : all)
    call += " " + word;
  SCOPED_TRACE("voxtouch" + call + "\n" + run.err);
  EXPECT_NE(run.status, 0);
  EXPECT_LT(run.status, 128) << "a signal ended it";
  EXPECT_EQ(run.out, "");
  EXPECT_NE(run.err.find(says), std::string::npos) << "expected: " << says;
  EXPECT_EQ(run.err.find(" settings, "), std::string::npos)
      << "it measured before it looked at its arguments";
}

TEST(AccuracyVerb, RefusesInvalidRequestsBeforeMeasuring) {
  expect_refused({"--models", "best"}, "--models: best");
  expect_refused({"--voxel-sizes", "0.002,0"}, "--voxel-sizes: '0'");
  expect_refused({"--voxel-sizes", "-0.002"}, "--voxel-sizes: '-0.002'");
  expect_refused({"--voxel-sizes", "nan"}, "--voxel-sizes: 'nan'");
  expect_refused({"--voxel-sizes", "2mm"}, "--voxel-sizes");
  expect_refused({"--models", "adapted", "field"}, ": field");
  expect_refused({"--shell-densities", "0"}, "--shell-densities: '0'");
  expect_refused({"--weights", "one", "--models", "field"}, "--weights one: ");
  expect_refused({"--weights", "heavy"}, "--weights: heavy");
  expect_refused({"--want-direction-deg", "1", "--within-us", "200"}, "limit");
  expect_refused({"--want-noise", "0"}, "noise is 0");
  expect_refused({"--contacts", "0"}, "--contacts");
  expect_refused({"--contacts", "-5"}, "--contacts");
  expect_refused({"--seed", "-1"}, "--seed");
  expect_refused({"--depth-edges", "nan"}, "--depth-edges");
  expect_refused({"--depth-edges", "0"}, "--depth-edges");
  expect_refused({"--csv", "/no/such/folder/a.csv"}, "/no/such/folder/a.csv");
}

TEST(AccuracyVerb, RefusedSceneLeavesNoFile) {
  const TemporaryFolder folder;
  std::ofstream(folder / "bad.yaml") << "scene: 1\n";
  const Finished run = voxtouch(
      {"accuracy", (folder / "bad.yaml").string(), "--csv", (folder / "a.csv").string(), "--json"});
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(nlohmann::json::parse(run.out)["ok"], false);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.csv.part"));
}

TEST(AccuracyVerb, TakesTheSceneBeforeOrAfterItsLists) {
  const Finished run = voxtouch(
      {"accuracy", "--contacts", "4", "--voxel-sizes", "0.004", "--models", "original", kPlane});
  EXPECT_EQ(run.status, 0) << run.err;
}

TEST(AccuracyVerb, HelpHasAnExample) {
  const Finished run = voxtouch({"accuracy", "--help"});
  EXPECT_EQ(run.status, 0);
  for (const char* word :
       {"Examples", "--want-direction-deg", "--within-us", "--shell-densities", "Pareto"})
    EXPECT_NE(run.out.find(word), std::string::npos) << word;
}

}  // namespace
}  // namespace voxtouch::test
