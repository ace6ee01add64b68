/// The advice: the row of each case, and that its sentence names the rows and figures that it
/// speaks of, and no other row.
#include <gtest/gtest.h>

#include <algorithm>
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

/// `all` are what was judged, `named` the places of those that the sentence is to name, `figures`
/// what else has to stand there.
void expect_tells(const AccuracyAdvice& advice, const std::vector<AccuracyRow>& all,
                  const std::vector<std::size_t>& named, const std::vector<std::string>& figures) {
  for (std::size_t n = 0; n < all.size(); ++n)
    EXPECT_EQ(advice.sentence.contains(describe(all[n].setting)), std::ranges::count(named, n) == 1)
        << n << " in " << advice.sentence;
  for (const std::string& figure : figures)
    EXPECT_TRUE(advice.sentence.contains(figure)) << figure << " in " << advice.sentence;
}

TEST(AccuracyAdvice, NamesTheCheapestSettingForAWantedDirectionError) {
  const AccuracyAdvice advice = advise(rows(), {.direction_deg = 2.5});
  EXPECT_EQ(advice.row, 2u) << "adapted keeps the wish too, and takes longer";
  EXPECT_EQ(advice.met, true);
  expect_tells(advice, rows(), {2}, {"2.5 deg", "10 us", "0.5 deg"});
}

/// A tool that is no ball: its truth is not known, and that is no reason to leave it.
TEST(AccuracyAdvice, RecommendsNothingAgainstAVirtualToolThatWasNotJudged) {
  std::vector<AccuracyRow> all = rows();
  all.push_back(refused());
  all.back().setting.virtual_tool = true;
  for (const AccuracyGoal& goal :
       {AccuracyGoal{}, AccuracyGoal{.direction_deg = 2.5}, AccuracyGoal{.within_us = 15.0}}) {
    const AccuracyAdvice advice = advise(all, goal, true);
    EXPECT_FALSE(advice.row);
    EXPECT_FALSE(advice.knee);
    expect_tells(advice, rows(), {}, {"virtual tool", "it would need 80 GB"});
    EXPECT_TRUE(advise(all, goal).row) << "another scene renders a penalty model";
  }
  AccuracyRow judged = row(contact::ContactModelKind::kField, 0.002, 7, 1.0);
  judged.setting.virtual_tool = true;
  all.push_back(judged);
  EXPECT_TRUE(advise(all, {.within_us = 15.0}, true).row) << "at another voxel size it was";
}

TEST(AccuracyAdvice, CountsAWishThatIsJustKept) {
  EXPECT_EQ(advise(rows(), {.direction_deg = 8.0}).row, 0u);
  EXPECT_EQ(advise(rows(), {.within_us = 10.0}).row, 2u);
}

TEST(AccuracyAdvice, SaysWhatComesNearestToAnErrorThatNothingKeepsAndByHowMuchItMisses) {
  const AccuracyAdvice advice = advise(rows(), {.direction_deg = 0.01});
  EXPECT_EQ(advice.row, 3u);
  EXPECT_EQ(advice.met, false);
  expect_tells(advice, rows(), {3}, {"0.01 deg", "5 times", "0.04 deg"});
}

TEST(AccuracyAdvice, KeepsEveryErrorThatIsWanted) {
  const AccuracyAdvice both = advise(rows(), {.direction_deg = 2.5, .noise = 0.01});
  EXPECT_EQ(both.row, 3u);
  expect_tells(both, rows(), {3}, {"2.5 deg", "1 %", "0.25 %"});
  EXPECT_EQ(advise(rows(), {.torque_m = 1e-4}).row, 2u);
  EXPECT_EQ(advise(rows(), {.onset_m = 1e-5}).row, 3u)
      << "too late is an error as well as too early";
  const AccuracyAdvice missed = advise(rows(), {.direction_deg = 0.04, .noise = 0.0005});
  EXPECT_EQ(missed.met, false);
  expect_tells(missed, rows(), {3}, {"0.04 deg", "0.05 %", "5 times", "0.2 %"});
}

TEST(AccuracyAdvice, NamesTheMostAccurateSettingWithinAWantedTime) {
  const AccuracyAdvice advice = advise(rows(), {.within_us = 50});
  EXPECT_EQ(advice.row, 2u);
  EXPECT_EQ(advice.met, true);
  expect_tells(advice, rows(), {2}, {"50 us", "10 us", "0.5 deg"});
}

TEST(AccuracyAdvice, SaysWhatComesNearestToATimeThatNothingKeepsAndByHowMuchItMisses) {
  const AccuracyAdvice advice = advise(rows(), {.within_us = 4});
  EXPECT_EQ(advice.row, 0u);
  EXPECT_EQ(advice.met, false);
  expect_tells(advice, rows(), {0}, {"4 us", "1 us", "25 %"});
}

TEST(AccuracyAdvice, NamesTheKneeAndTheEndsOfTheFrontWithoutAWish) {
  const AccuracyAdvice advice = advise(rows(), {});
  EXPECT_EQ(advice.front, (std::vector<std::size_t>{0, 2, 3}));
  EXPECT_EQ(advice.knee, 2u);
  EXPECT_EQ(advice.row, 2u);
  EXPECT_FALSE(advice.met);
  expect_tells(advice, rows(), {0, 2, 3}, {"90 us", "0.05 deg", "10 times", "9 times"});
}

TEST(AccuracyAdvice, NamesBothEndsOfAFrontOfTwoAndTheOneOfAFrontOfOne) {
  const std::vector<AccuracyRow> two{rows()[0], rows()[3]};
  const AccuracyAdvice ends = advise(two, {});
  EXPECT_FALSE(ends.row);
  expect_tells(ends, two, {0, 1}, {"5 us", "8 deg", "90 us", "0.05 deg"});
  const AccuracyAdvice one = advise({rows()[2]}, {});
  EXPECT_EQ(one.row, 0u);
  expect_tells(one, rows(), {2}, {"10 us", "0.5 deg"});
  const AccuracyAdvice best = advise({rows()[1], rows()[2]}, {});
  EXPECT_EQ(best.row, 1u);
  expect_tells(best, rows(), {2}, {"10 us", "0.5 deg"});
  EXPECT_NE(best.sentence, one.sentence) << "there was another to compare it with";
}

TEST(AccuracyAdvice, NeverChoosesWhatWasRefusedOrNeverTouchedOrIsNotANumber) {
  AccuracyRow untouched = row(contact::ContactModelKind::kAdapted, 0.002, 1, 0.0);
  untouched.contacts = 0;
  AccuracyRow odd =
      row(contact::ContactModelKind::kAdapted, 0.002, 1, std::numeric_limits<double>::quiet_NaN());
  const std::vector<AccuracyRow> all{refused(), untouched, odd, rows()[1]};
  for (const AccuracyGoal& goal :
       {AccuracyGoal{}, AccuracyGoal{.direction_deg = 1}, AccuracyGoal{.direction_deg = 90},
        AccuracyGoal{.within_us = 1}, AccuracyGoal{.within_us = 1e6}})
    EXPECT_EQ(advise(all, goal).row, 3u) << advise(all, goal).sentence;
}

TEST(AccuracyAdvice, ARowWithoutTheWantedFigureDoesNotKeepTheWish) {
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
  expect_tells(none, all, {}, {"magnitude noise", "10 %"});
}

TEST(AccuracyAdvice, SaysSoWhereNothingCouldBeJudged) {
  for (const AccuracyGoal& goal :
       {AccuracyGoal{}, AccuracyGoal{.direction_deg = 1}, AccuracyGoal{.within_us = 1}}) {
    const AccuracyAdvice advice = advise({refused(), refused()}, goal);
    EXPECT_FALSE(advice.row);
    EXPECT_NE(advice.met, true);
    expect_tells(advice, {refused(), refused()}, {}, {" 2 "});
  }
  EXPECT_FALSE(advise({}, {}).row);
}

TEST(AccuracyAdvice, DoesNotTellErrorsApartThatNoHandFeels) {
  const std::vector<AccuracyRow> alike{row(contact::ContactModelKind::kAdapted, 0.002, 5, 1e-7),
                                       row(contact::ContactModelKind::kField, 0.002, 50, 0.0)};
  const AccuracyAdvice advice = advise(alike, {});
  EXPECT_EQ(advice.front, std::vector<std::size_t>{0});
  expect_tells(advice, alike, {0}, {"0.001 deg"});
  EXPECT_EQ(advise(alike, {.within_us = 100}).row, 0u);
}

TEST(AccuracyAdvice, TakesTheFasterThenTheSmallerThenTheFirstOfEquals) {
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

TEST(AccuracyGoal, RefusesWhatCannotBeWanted) {
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

TEST(AccuracySettingNames, TellTheShellOnlyWhereItIsAnother) {
  AccuracySetting s{contact::ContactModelKind::kAdapted, contact::PointWeights::kOne, 0.002, 0.002};
  EXPECT_EQ(describe(s), "adapted/one, e = 2 mm");
  s.shell_voxel_m = 0.0005;
  EXPECT_EQ(describe(s), "adapted/one, e = 2 mm, shell 0.5 mm");
}

}  // namespace
}  // namespace voxtouch::accuracy
