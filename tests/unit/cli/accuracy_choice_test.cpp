/// From words to settings: defaults, order, and refusals with their sentences.
#include <gtest/gtest.h>

#include <stdexcept>

#include "nodes/cli/accuracy/accuracy_choice.hpp"

namespace voxtouch::cli {
namespace {

std::vector<std::string> names(const std::vector<accuracy::AccuracySetting>& settings) {
  std::vector<std::string> out;
  for (const accuracy::AccuracySetting& s : settings)
    out.push_back(describe(s));
  return out;
}

void expect_refused(const AccuracyChoice& ask, const std::vector<std::string>& words) {
  try {
    settings_of(ask, 0.002);
    ADD_FAILURE() << "accepted; expected " << words[0];
  } catch (const std::invalid_argument& error) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
          << word << " in " << error.what();
  }
}

TEST(AccuracyChoice, DefaultsToAllModelsAtThreeVoxelSizes) {
  const auto settings = settings_of({}, 0.002);
  ASSERT_EQ(settings.size(), 16u)
      << "original and adapted twice, field by area, three sizes each; the virtual tool";
  EXPECT_EQ(describe(settings[0]), "original/one, e = 4 mm");
  EXPECT_EQ(describe(settings[5]), "original/area, e = 1 mm");
  EXPECT_EQ(describe(settings[14]), "field/area, e = 1 mm");
  EXPECT_EQ(describe(settings[15]), "virtual tool, e = 2 mm");
  EXPECT_EQ(names(settings_of({.models = {"virtual_tool"}, .voxel_sizes_m = {0.004, 0.002}}, 0.1)),
            (std::vector<std::string>{"virtual tool, e = 4 mm", "virtual tool, e = 2 mm"}));
}

TEST(AccuracyChoice, KeepsTheOrderAndRemovesDuplicates) {
  EXPECT_EQ(names(settings_of({.models = {"field", "adapted", "field"},
                               .weights = {"area", "one"},
                               .voxel_sizes_m = {0.001, 0.004, 0.001},
                               .shell_densities = {}},
                              0.002)),
            (std::vector<std::string>{"field/area, e = 1 mm", "field/area, e = 4 mm",
                                      "adapted/area, e = 1 mm", "adapted/area, e = 4 mm",
                                      "adapted/one, e = 1 mm", "adapted/one, e = 4 mm"}));
}

TEST(AccuracyChoice, MakesADenserShellWithSmallerVoxels) {
  EXPECT_EQ(names(settings_of({.models = {"adapted"},
                               .weights = {"one"},
                               .voxel_sizes_m = {0.002},
                               .shell_densities = {1, 2, 0.5}},
                              0.1)),
            (std::vector<std::string>{"adapted/one, e = 2 mm", "adapted/one, e = 2 mm, shell 1 mm",
                                      "adapted/one, e = 2 mm, shell 4 mm"}));
}

TEST(AccuracyChoice, SkipsAreaModelsIfOnlyUnitWeightsAreGiven) {
  EXPECT_EQ(names(settings_of({.weights = {"one"}, .voxel_sizes_m = {0.002}}, 0.1)),
            (std::vector<std::string>{"original/one, e = 2 mm", "adapted/one, e = 2 mm"}));
}

TEST(AccuracyChoice, RefusesAModelByAreaWithWeightsOfOne) {
  expect_refused({.models = {"adapted", "field"}, .weights = {"one"}},
                 {"--weights one", "'field'", "Add area"});
}

TEST(AccuracyChoice, RefusesTooManySettings) {
  std::vector<double> sizes;
  for (int i = 1; i <= 200; ++i)
    sizes.push_back(0.001 * i);
  expect_refused({.voxel_sizes_m = sizes}, {"1200 settings", "limit 500"});
}

TEST(AccuracySettingNames, NameTheShellOnlyIfItDiffers) {
  accuracy::AccuracySetting s{contact::ContactModelKind::kAdapted, contact::PointWeights::kOne,
                              0.002, 0.002};
  EXPECT_EQ(describe(s), "adapted/one, e = 2 mm");
  s.shell_voxel_m = 0.0005;
  EXPECT_EQ(describe(s), "adapted/one, e = 2 mm, shell 0.5 mm");
}

}  // namespace
}  // namespace voxtouch::cli
