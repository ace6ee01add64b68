/// `voxtouch design`: the report, its JSON, and refusals. The stable region and its picture:
/// plot_test.py.
#include <gtest/gtest.h>

#include "tests/golden/golden.hpp"

namespace voxtouch::test {
namespace {

const std::string kCup = std::string(VOXTOUCH_DEPLOY) + "/scenes/cup.yaml";

TEST(DesignVerb, PrintsTheDesignItsMarginAndItsLimit) {
  const Finished run = voxtouch({"design", "--device", "sim-phantom", "--scene", kCup});
  EXPECT_EQ(run.status, 0) << run.err;
  for (const char* word :
       {"shaping filter", "margin", "stability limit", "paper ", "UNSTABLE", "Limits:"})
    EXPECT_NE(run.out.find(word), std::string::npos) << word << " in\n" << run.out;
}

/// The status of the design refers to reasons: each is printed, and in the JSON.
TEST(DesignVerb, PrintsTheReasonsOfAReducedStiffness) {
  std::vector<std::string> words{"design", "--device", "sim-phantom", "--scene", kCup};
  const Finished text = voxtouch(words);
  words.push_back("--json");
  const nlohmann::json j = nlohmann::json::parse(voxtouch(words).out);
  ASSERT_EQ(j["status"], "stiffness_reduced");
  ASSERT_FALSE(j["reasons"].empty());
  for (const auto& reason : j["reasons"])
    EXPECT_NE(text.out.find(reason.get<std::string>()), std::string::npos) << reason;
}

TEST(DesignVerb, PrintsOneJsonObjectWithTheRequestedMargin) {
  for (const double margin : {1.5, 2.0, 3.0}) {
    const Finished run = voxtouch({"design", "--device", "sim-phantom", "--kind", "shaping_filter",
                                   "--gain-margin", std::to_string(margin), "--json"});
    ASSERT_EQ(run.status, 0) << run.err;
    const nlohmann::json j = nlohmann::json::parse(run.out);
    EXPECT_EQ(j["ok"], true);
    EXPECT_GE(j["translation"]["gain_margin"].get<double>(), margin * (1 - 1e-9));
    EXPECT_NEAR(j["translation"]["critical_stiffness"].get<double>(),
                j["translation"]["displayed_stiffness"].get<double>() *
                    j["translation"]["gain_margin"].get<double>(),
                1e-6 * j["translation"]["critical_stiffness"].get<double>());
    EXPECT_EQ(j["paper_recipe"]["released"]["stable"], false);
  }
}

TEST(DesignVerb, PrintsCertifiedContactsAndTheLimits) {
  const Finished text = voxtouch({"design", "--device", "sim-phantom"});
  EXPECT_NE(
      text.out.find("certificate   any contact whose force does not decrease with depth, up to "),
      std::string::npos)
      << text.out;
  EXPECT_NE(text.out.find("Not covered by the certificate:\n"
                          "   - Injected damping acts only in contact"),
            std::string::npos)
      << text.out;
  const Finished run = voxtouch({"design", "--device", "sim-phantom", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const nlohmann::json certificate = nlohmann::json::parse(run.out)["certificate"];
  EXPECT_EQ(certificate["contact"], "monotone");
  EXPECT_EQ(certificate["proof"], "multiplier");
  EXPECT_GE(certificate["translation"]["margin"].get<double>(), 1.5);
  EXPECT_EQ(certificate["leaves_out"][0], "damper_gate");
  double sum = 0.0;
  for (const char* side : {"past", "future"})
    for (const double h : certificate["multiplier"][side]) {
      EXPECT_GE(h, 0.0);
      sum += h;
    }
  EXPECT_LT(sum, 1.0);
}

TEST(DesignVerb, PaperRecipeIsStableForSoftContactAndDamping) {
  const Finished run = voxtouch({"design", "--device", "sim-lwr", "--stiffness", "200", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const nlohmann::json j = nlohmann::json::parse(run.out);
  EXPECT_EQ(j["paper_recipe"]["released"]["stable"], true);
  EXPECT_EQ(j["paper_recipe"]["gripped"]["stable"], true);
}

TEST(DesignVerb, DesignsForADeviceFile) {
  const Finished run = voxtouch(
      {"design", "--device", std::string(VOXTOUCH_DEPLOY) + "/devices/premium_3.yaml", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_GT(nlohmann::json::parse(run.out)["translation"]["displayed_stiffness"].get<double>(),
            250.0);
}

TEST(DesignVerb, ExitsWithOneIfInfeasible) {
  const Finished run = voxtouch({"design", "--device", "sim-phantom", "--hand", "any_passive"});
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.out.find("infeasible"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("Ns/m"), std::string::npos);
}

TEST(DesignVerb, NamesTheKnownDevicesForAnUnknownOne) {
  const Finished run = voxtouch({"design", "--device", "omni"});
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("sim-phantom"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace voxtouch::test
