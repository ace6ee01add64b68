#include "core/first_scene/model_choice.hpp"

#include <gtest/gtest.h>

namespace voxtouch::first_scene {
namespace {

using contact::ContactModelKind;

/// Rows of models_to_measure, all of them good, the virtual tool less exact than `field`.
class MeasuredModel : public testing::Test {
 protected:
  MeasuredModel() {
    for (const accuracy::AccuracySetting& setting : models_to_measure(0.001)) {
      accuracy::AccuracyRow& row = rows.emplace_back();
      row.setting = setting;
      row.contacts = kMeasuredContacts;
      row.direction_mean_deg = setting.virtual_tool                        ? 2.0
                               : setting.model == ContactModelKind::kField ? 0.5
                                                                           : 3.0;
      row.median_us = 3.0;
    }
  }
  accuracy::AccuracyRow& adapted() { return rows[0]; }
  accuracy::AccuracyRow& field() { return rows[1]; }
  accuracy::AccuracyRow& tool() { return rows[2]; }
  static void refuse(accuracy::AccuracyRow& row) {
    const accuracy::AccuracySetting setting = row.setting;
    row = {};
    row.setting = setting;
    row.refused = "it cannot be built";
  }
  ModelChoice choice() const {
    return measured_model(rows, {ContactModelKind::kField, true, "Usual."});
  }

  std::vector<accuracy::AccuracyRow> rows;
};

TEST_F(MeasuredModel, IsTheVirtualToolThoughFieldPointsBetter) {
  EXPECT_TRUE(choice().virtual_tool);
}

TEST_F(MeasuredModel, IsFieldWhereTheVirtualToolMissesContacts) {
  tool().missed = 1;
  EXPECT_FALSE(choice().virtual_tool);
  EXPECT_EQ(choice().model, ContactModelKind::kField);
}

TEST_F(MeasuredModel, IsAnotherWhereTheVirtualToolIsFarOff) {
  tool().direction_mean_deg = 25.0;
  EXPECT_FALSE(choice().virtual_tool);
}

TEST_F(MeasuredModel, IsTheOneThatPointsBestOfThoseThatAreFastEnough) {
  tool().median_us = field().median_us = 900.0;
  EXPECT_FALSE(choice().virtual_tool);
  EXPECT_EQ(choice().model, ContactModelKind::kAdapted);
}

TEST_F(MeasuredModel, LetsFieldSpeakForAVirtualToolWhoseTruthIsNotKnown) {
  refuse(tool());
  field().direction_mean_deg = 30.0;  // at a tool's corner
  EXPECT_TRUE(choice().virtual_tool);
  field().missed = 3;
  EXPECT_FALSE(choice().virtual_tool);
  EXPECT_EQ(choice().model, ContactModelKind::kAdapted);
}

TEST_F(MeasuredModel, IsTheUsualOneWhereNothingCouldBeMeasured) {
  for (accuracy::AccuracyRow& row : rows)
    refuse(row);
  EXPECT_TRUE(choice().virtual_tool);
  EXPECT_NE(choice().reason.find("No contact"), std::string::npos);
}

TEST_F(MeasuredModel, TellsWhatWasMeasured) {
  const std::string reason = choice().reason;
  for (const char* figure : {"2.0 degrees", "0.5 degrees", "3.0 degrees"})
    EXPECT_NE(reason.find(figure), std::string::npos) << reason;
}

}  // namespace
}  // namespace voxtouch::first_scene
