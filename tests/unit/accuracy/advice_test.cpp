/// The choice between measured settings: the row of each case.
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "core/accuracy/advice.hpp"

namespace voxtouch::accuracy {
namespace {

AccuracyRow row(contact::ContactModelKind model, double voxel_m, double time_us,
                double direction_deg) {
  AccuracyRow r;
  r.setting = {model, contact::PointWeights::kArea, voxel_m, voxel_m};
  r.contacts = 100;
  r.direction_mean_deg = direction_deg;
  r.magnitude_noise = direction_deg / 20.0;
  r.torque_error_m = direction_deg * 1e-4;
  r.onset_error_m = -direction_deg * 1e-4;
  r.median_us = time_us;
  r.bytes = 1000;
  return r;
}

/// Front 0, 2, 3; row 1 is beaten by row 2.
std::vector<AccuracyRow> rows() {
  return {row(contact::ContactModelKind::kOriginal, 0.004, 5, 8.0),
          row(contact::ContactModelKind::kAdapted, 0.002, 20, 2.3),
          row(contact::ContactModelKind::kField, 0.004, 10, 0.5),
          row(contact::ContactModelKind::kField, 0.001, 90, 0.05)};
}

AccuracyRow refused() {
  AccuracyRow r;
  r.setting.voxel_m = r.setting.shell_voxel_m = 0.0001;
  r.refused = "it would need 80 GB";
  return r;
}

TEST(AccuracyAdvice, ChoosesTheCheapestWithinADirectionError) {
  const AccuracyAdvice advice = advise(rows(), {.direction_deg = 2.5});
  EXPECT_EQ(advice.row, 2u) << "adapted keeps the request too, and takes longer";
  EXPECT_EQ(advice.met, true);
}

/// A tool that is no ball: its truth is not known, and that is no reason to leave it.
TEST(AccuracyAdvice, ChoosesNothingOverAnUnmeasuredVirtualTool) {
  std::vector<AccuracyRow> all = rows();
  all.push_back(refused());
  all.back().setting.virtual_tool = true;
  for (const AccuracyGoal& goal :
       {AccuracyGoal{}, AccuracyGoal{.direction_deg = 2.5}, AccuracyGoal{.within_us = 15.0}}) {
    const AccuracyAdvice advice = advise(all, goal, true);
    EXPECT_FALSE(advice.row);
    EXPECT_FALSE(advice.knee);
    EXPECT_EQ(advice.refused_tool, 4u);
    EXPECT_TRUE(advise(all, goal).row) << "another scene renders a penalty model";
  }
  AccuracyRow judged = row(contact::ContactModelKind::kField, 0.002, 7, 1.0);
  judged.setting.virtual_tool = true;
  all.push_back(judged);
  EXPECT_TRUE(advise(all, {.within_us = 15.0}, true).row) << "at another voxel size it was";
}

TEST(AccuracyAdvice, CountsAnExactlyMetLimit) {
  EXPECT_EQ(advise(rows(), {.direction_deg = 8.0}).row, 0u);
  EXPECT_EQ(advise(rows(), {.within_us = 10.0}).row, 2u);
}

TEST(AccuracyAdvice, ChoosesTheNearestToAnUnmetError) {
  const AccuracyAdvice advice = advise(rows(), {.direction_deg = 0.01});
  EXPECT_EQ(advice.row, 3u);
  EXPECT_EQ(advice.met, false);
}

TEST(AccuracyAdvice, MeetsEveryErrorLimit) {
  const AccuracyAdvice both = advise(rows(), {.direction_deg = 2.5, .noise = 0.01});
  EXPECT_EQ(both.row, 3u);
  EXPECT_EQ(advise(rows(), {.torque_m = 1e-4}).row, 2u);
  EXPECT_EQ(advise(rows(), {.onset_m = 1e-5}).row, 3u)
      << "too late is an error as well as too early";
  const AccuracyAdvice missed = advise(rows(), {.direction_deg = 0.04, .noise = 0.0005});
  EXPECT_EQ(missed.met, false);
}

TEST(AccuracyAdvice, ChoosesTheMostAccurateSettingWithinATime) {
  const AccuracyAdvice advice = advise(rows(), {.within_us = 50});
  EXPECT_EQ(advice.row, 2u);
  EXPECT_EQ(advice.met, true);
}

TEST(AccuracyAdvice, ChoosesTheNearestToAnUnmetTime) {
  const AccuracyAdvice advice = advise(rows(), {.within_us = 4});
  EXPECT_EQ(advice.row, 0u);
  EXPECT_EQ(advice.met, false);
}

TEST(AccuracyAdvice, ChoosesTheKneeOfTheFrontWithoutALimit) {
  const AccuracyAdvice advice = advise(rows(), {});
  EXPECT_EQ(advice.front, (std::vector<std::size_t>{0, 2, 3}));
  EXPECT_EQ(advice.knee, 2u);
  EXPECT_EQ(advice.row, 2u);
  EXPECT_FALSE(advice.met);
}

TEST(AccuracyAdvice, FrontOfTwoGivesNoAdviceFrontOfOneDoes) {
  const std::vector<AccuracyRow> two{rows()[0], rows()[3]};
  const AccuracyAdvice ends = advise(two, {});
  EXPECT_FALSE(ends.row);
  const AccuracyAdvice one = advise({rows()[2]}, {});
  EXPECT_EQ(one.row, 0u);
  const AccuracyAdvice best = advise({rows()[1], rows()[2]}, {});
  EXPECT_EQ(best.row, 1u);
}

TEST(AccuracyAdvice, NeverChoosesRefusedUntouchedOrNonFiniteRows) {
  AccuracyRow untouched = row(contact::ContactModelKind::kAdapted, 0.002, 1, 0.0);
  untouched.contacts = 0;
  AccuracyRow odd =
      row(contact::ContactModelKind::kAdapted, 0.002, 1, std::numeric_limits<double>::quiet_NaN());
  const std::vector<AccuracyRow> all{refused(), untouched, odd, rows()[1]};
  for (const AccuracyGoal& goal :
       {AccuracyGoal{}, AccuracyGoal{.direction_deg = 1}, AccuracyGoal{.direction_deg = 90},
        AccuracyGoal{.within_us = 1}, AccuracyGoal{.within_us = 1e6}})
    EXPECT_EQ(advise(all, goal).row, 3u);
}

TEST(AccuracyAdvice, RowWithoutTheFigureMissesTheLimit) {
  std::vector<AccuracyRow> all = rows();
  for (AccuracyRow& r : all)
    r.magnitude_noise = std::numeric_limits<double>::quiet_NaN();
  all[3].magnitude_noise = 0.5;
  const AccuracyAdvice advice = advise(all, {.noise = 0.1});
  EXPECT_EQ(advice.row, 3u);
  EXPECT_EQ(advice.met, false);
  all.pop_back();
  const AccuracyAdvice none = advise(all, {.noise = 0.1});
  EXPECT_FALSE(none.row);
  EXPECT_EQ(none.met, false);
}

TEST(AccuracyAdvice, ChoosesNothingIfNothingWasMeasured) {
  for (const AccuracyGoal& goal :
       {AccuracyGoal{}, AccuracyGoal{.direction_deg = 1}, AccuracyGoal{.within_us = 1}}) {
    const AccuracyAdvice advice = advise({refused(), refused()}, goal);
    EXPECT_FALSE(advice.row);
    EXPECT_NE(advice.met, true);
  }
  EXPECT_FALSE(advise({}, {}).row);
}

TEST(AccuracyAdvice, TreatsImperceptibleErrorsAsEqual) {
  const std::vector<AccuracyRow> alike{row(contact::ContactModelKind::kAdapted, 0.002, 5, 1e-7),
                                       row(contact::ContactModelKind::kField, 0.002, 50, 0.0)};
  const AccuracyAdvice advice = advise(alike, {});
  EXPECT_EQ(advice.front, std::vector<std::size_t>{0});
  EXPECT_EQ(advise(alike, {.within_us = 100}).row, 0u);
}

TEST(AccuracyAdvice, BreaksTiesBySpeedSizeAndOrder) {
  std::vector<AccuracyRow> equals{row(contact::ContactModelKind::kAdapted, 0.002, 5, 1.0),
                                  row(contact::ContactModelKind::kField, 0.002, 5, 1.0),
                                  row(contact::ContactModelKind::kField, 0.001, 5, 1.0)};
  EXPECT_EQ(advise(equals, {.direction_deg = 2}).row, 0u);
  equals[1].bytes = 10;
  EXPECT_EQ(advise(equals, {.direction_deg = 2}).row, 1u);
  EXPECT_EQ(advise(equals, {.within_us = 9}).row, 1u);
  equals[2].median_us = 4;
  EXPECT_EQ(advise(equals, {.direction_deg = 2}).row, 2u);
}

TEST(AccuracyGoal, RefusesAnInvalidGoal) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               inf = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, nan, inf}) {
    EXPECT_THROW(AccuracyGoal{.direction_deg = bad}.validate(), std::invalid_argument) << bad;
    EXPECT_THROW(AccuracyGoal{.noise = bad}.validate(), std::invalid_argument) << bad;
    EXPECT_THROW(AccuracyGoal{.torque_m = bad}.validate(), std::invalid_argument) << bad;
    EXPECT_THROW(AccuracyGoal{.onset_m = bad}.validate(), std::invalid_argument) << bad;
    EXPECT_THROW(AccuracyGoal{.within_us = bad}.validate(), std::invalid_argument) << bad;
  }
  EXPECT_THROW((AccuracyGoal{.noise = 1, .within_us = 5}.validate()), std::invalid_argument);
  EXPECT_NO_THROW((AccuracyGoal{.direction_deg = 1, .noise = 1}.validate()));
  EXPECT_NO_THROW(AccuracyGoal{}.validate());
}

}  // namespace
}  // namespace voxtouch::accuracy
