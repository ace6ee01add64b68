/// `voxtouch plan` and `voxtouch schema` from the command line.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/golden/golden.hpp"

namespace voxtouch::test {
namespace {

const std::string kScenes = std::string(VOXTOUCH_DEPLOY) + "/scenes";
const std::string kCylinder = kScenes + "/cylinder.yaml";

/// The cylinder with other words in place of `effects: []`.
std::string with_effects(const TemporaryFolder& folder, const std::string& effects) {
  std::string text = file_text(kCylinder);
  text.replace(text.find("effects: []"), 11, "effects: " + effects);
  for (std::size_t at; (at = text.find("../meshes")) != std::string::npos;)
    text.replace(at, 9, std::string(VOXTOUCH_DEPLOY) + "/meshes");
  std::ofstream(folder / "scene.yaml") << text;
  return (folder / "scene.yaml").string();
}

nlohmann::json plan_json(std::vector<std::string> more, int status = 0) {
  std::vector<std::string> all{"plan", "--json"};
  all.insert(all.end(), more.begin(), more.end());
  const Finished run = voxtouch(all);
  EXPECT_EQ(run.status, status) << run.err;
  return nlohmann::json::parse(run.out);
}

const nlohmann::json& part(const nlohmann::json& plan, const std::string& name) {
  for (const auto& part : plan["parts"])
    if (part["name"] == name)
      return part;
  throw std::runtime_error("no part " + name);
}

TEST(PlanVerb, PrintsTheSameOnEveryMachineUnmeasured) {
  const std::vector<std::string> call{"plan", kCylinder, "--no-measure"};
  const Finished first = voxtouch(call), second = voxtouch(call);
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_EQ(first.out, second.out);
  EXPECT_EQ(first.out, file_text(kData / "golden/plan_cylinder.txt"))
      << "voxtouch plan deploy/scenes/cylinder.yaml --no-measure";
  EXPECT_EQ(plan_json({kCylinder, "--no-measure"}),
            nlohmann::json::parse(file_text(kData / "golden/plan_cylinder.json")));
}

TEST(PlanVerb, MeasuresEachPartNextToItsEstimate) {
  const TemporaryFolder folder;
  const nlohmann::json j = plan_json({with_effects(folder, "[{viscosity: {damping_ns_per_m: 1}}]"),
                                      "--device", "sim-phantom", "--frames", "200"});
  EXPECT_EQ(j["ok"], true);
  const nlohmann::json& m = j["measured"];
  EXPECT_EQ(m["along"], "circle") << "the first motion by name";
  EXPECT_EQ(m["frames"], 200);
  EXPECT_GT(m["touching"], 0);
  EXPECT_GT(m["hits"], 0.0);
  EXPECT_LE(m["points_tested"], j["shell_points"]);
  EXPECT_LE(m["frame_median_ns"], m["frame_p95_ns"]);
  EXPECT_LE(m["frame_p95_ns"], m["frame_worst_ns"]);
  for (const char* name : {"pointshell", "contact model adapted", "effect viscosity", "coupling"}) {
    SCOPED_TRACE(name);
    EXPECT_GE(part(j, name)["measured_ns"], 0.0);
    EXPECT_GT(part(j, name)["expected_ns"], 0.0);
    EXPECT_LE(part(j, name)["expected_ns"], part(j, name)["at_most_ns"]);
  }
  for (const char* name : {"voxmap", "culling tree", "topic device/state", "node logger"})
    EXPECT_TRUE(part(j, name)["measured_ns"].is_null()) << name;
}

/// A hand at rest or moving straight in keeps the rows of the previous frame: such frames do not
/// measure the cost of a virtual tool.
TEST(PlanVerb, TimesAVirtualToolDuringASlidingMotion) {
  const TemporaryFolder folder;
  std::string text = file_text(kScenes + "/cup_virtual_tool.yaml");
  for (std::size_t at; (at = text.find("../meshes")) != std::string::npos;)
    text.replace(at, 9, std::string(VOXTOUCH_DEPLOY) + "/meshes");
  std::ofstream(folder / "still.yaml") << text.substr(0, text.find("motions:"));
  for (const std::string& scene :
       {kScenes + "/cup_virtual_tool.yaml", kScenes + "/press_virtual_tool.yaml",
        (folder / "still.yaml").string()}) {
    SCOPED_TRACE(scene);
    const nlohmann::json j = plan_json({scene, "--frames", "60"});
    const nlohmann::json& m = j["measured"];
    EXPECT_GT(m["touching"], 0);
    EXPECT_GT(m["points_tested"], 0.0);
    EXPECT_GE(m["queries_per_frame"], 0.5);
    EXPECT_LE(m["frame_median_ns"], m["frame_p95_ns"]);
    EXPECT_GT(part(j, "virtual tool")["measured_ns"], 0.0);
    EXPECT_GT(part(j, "virtual tool")["expected_ns"], 0.0);
    EXPECT_EQ(j.dump().find("contact model field"), std::string::npos) << "the tool needs none";
  }
}

TEST(PlanVerb, UsesSeededPlacesWithoutAMotion) {
  const TemporaryFolder folder;
  std::string text = file_text(with_effects(folder, "[]"));
  std::ofstream(folder / "scene.yaml") << text.substr(0, text.find("motions:"));
  const nlohmann::json j = plan_json({(folder / "scene.yaml").string(), "--frames", "50"});
  EXPECT_TRUE(j["measured"]["along"].is_null());
  EXPECT_GT(j["measured"]["touching"], 0);
  EXPECT_EQ(j["measured"]["touching"], plan_json({(folder / "scene.yaml").string(), "--frames",
                                                  "50"})["measured"]["touching"]);
  EXPECT_TRUE(part(j, "coupling")["measured_ns"].is_null())
      << "it is designed for a device, and none is named";
}

TEST(PlanVerb, BuildsForTheNamedModel) {
  const nlohmann::json j =
      plan_json({kScenes + "/cup_field.yaml", "--model", "adapted", "--no-measure"});
  EXPECT_EQ(j["contact_model"], "adapted");
  EXPECT_EQ(j.dump().find("\"distance field\""), std::string::npos);
  EXPECT_GT(
      part(plan_json({kScenes + "/cup_field.yaml", "--no-measure"}), "distance field")["bytes"],
      100'000);
}

TEST(PlanVerb, PrintsDeviceLimitsAndExitsWithOneIfImpossible) {
  const TemporaryFolder folder;
  const std::string rotation =
      with_effects(folder, "[{viscosity: {damping_ns_per_m: 1, damping_nms_per_rad: 0.01}}]");
  const Finished run = voxtouch({"plan", rotation, "--device", "sim-phantom", "--no-measure"});
  EXPECT_EQ(run.status, 1);
  for (const char* word : {"sim-phantom", "'viscosity'", "torque"})
    EXPECT_NE(run.out.find(word), std::string::npos) << word << " in\n" << run.out;
  const nlohmann::json arm = plan_json({rotation, "--device", "sim-lwr", "--no-measure"});
  EXPECT_EQ(arm["device"]["errors"].size(), 0U);
  for (const auto& note : arm["device"]["notes"])
    EXPECT_EQ(note.get<std::string>().find("torque"), std::string::npos) << note;
}

TEST(PlanVerb, PrintsATable) {
  const Finished run = voxtouch({"plan", kCylinder, "--frames", "50", "--device", "sim-phantom"});
  ASSERT_EQ(run.status, 0) << run.err;
  for (const char* word : {"expected ns    measured ns", "culling tree", "(pointshell)", "Topics",
                           "Not built", "compare ratios", "On sim-phantom"})
    EXPECT_NE(run.out.find(word), std::string::npos) << word << " in\n" << run.out;
}

TEST(PlanVerb, RefusesInvalidOptions) {
  EXPECT_NE(voxtouch({"plan"}).status, 0);
  EXPECT_NE(voxtouch({"plan", "no_such.yaml"}).status, 0);
  EXPECT_NE(voxtouch({"plan", kCylinder, "--model", "best"}).status, 0);
  EXPECT_NE(voxtouch({"plan", kCylinder, "--frames", "0"}).status, 0);
  const Finished run = voxtouch({"plan", kCylinder, "--device", "omni", "--json", "--no-measure"});
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(nlohmann::json::parse(run.out)["ok"], false);
  EXPECT_NE(run.err.find("sim-phantom"), std::string::npos) << run.err;
}

TEST(SchemaVerb, PrintsTheShippedFile) {
  const Finished run = voxtouch({"schema"});
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.out, file_text(kScenes + "/scene.schema.json"));
}

}  // namespace
}  // namespace voxtouch::test
