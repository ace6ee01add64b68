// Limits of a run, on synthetic figures.
#include "nodes/cli/up/run_limits.hpp"
#include "nodes/cli/up/verdict_text.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace voxtouch::cli {
namespace {

/// Ten seconds as they should be.
RunFigures good_run() {
  RunFigures run;
  run.samples = 10'000, run.nominal_rate_hz = 1000, run.rate_hz = 999.2;
  run.first_answered = 240, run.answered = 9'752, run.overruns = 6, run.deadline_misses = 2,
  run.clamped = 0;
  run.validate_every = 20, run.first_judged = 300, run.judged = run.compared = 483, run.excused = 1;
  run.recording = true;
  run.streams = {{"device/state", 2, 0, 9'997, 10'000},
                 {"rendering/contact", 25, 25, 9'970, 9'975},
                 {"coupling/command", 240, 240, 9'755, 9'760}};
  run.silence_s = 0.11, run.silent = "coupling";
  run.start_differences = 0;
  return run;
}

std::vector<std::string> not_met(const RunFigures& run, const ChosenLimits& chosen = {}) {
  std::vector<std::string> names;
  for (const CheckedLimit& judged : judge_figures(run, chosen)) {
    if (!judged.met)
      names.emplace_back(judged.limit->name);
  }
  return names;
}

using Names = std::vector<std::string>;

TEST(RunLimits, AreMetByAHealthyRun) {
  EXPECT_EQ(not_met(good_run()), Names{});
  for (const CheckedLimit& judged : judge_figures(good_run(), {}))
    EXPECT_TRUE(judged.measured) << judged.limit->name;
}

struct Bad {
  const char* name;
  std::function<void(RunFigures&)> change;
  Names not_met;
};
void PrintTo(const Bad& bad, std::ostream* out) { *out << bad.name; }

class KnownBadRun : public testing::TestWithParam<Bad> {};

TEST_P(KnownBadRun, FailsTheRun) {
  RunFigures run = good_run();
  GetParam().change(run);
  EXPECT_EQ(not_met(run), GetParam().not_met);
}

INSTANTIATE_TEST_SUITE_P(
    All, KnownBadRun,
    testing::Values(
        Bad{"rate_826_of_1000", [](RunFigures& r) { r.rate_hz = 826; }, {"rate_ratio"}},
        Bad{"unanswered_28_percent",
            [](RunFigures& r) { r.answered = 0.72 * 9'760; },
            {"answered_ratio"}},
        Bad{"unanswered_60_percent",
            [](RunFigures& r) { r.answered = 0.40 * 9'760; },
            {"answered_ratio"}},
        Bad{"deadlines_133_missed",
            [](RunFigures& r) { r.deadline_misses = 133; },
            {"deadline_miss_ratio"}},
        Bad{"is_not_as_its_file_says",
            [](RunFigures& r) { r.start_differences = 1; },
            {"start_check_differences"}},
        Bad{"clamps_57", [](RunFigures& r) { r.clamped = 57; }, {"clamped_ratio"}},
        Bad{"was_in_a_wall_that_nothing_holds_it_from_passing",
            [](RunFigures& r) { r.passed_through = 1; },
            {"passed_through_samples"}},
        Bad{"may_have_passed_a_wall_once",
            [](RunFigures& r) { r.tunnelling_suspected = 1; },
            {"tunnelling_suspected_samples"}},
        Bad{"overruns_of_a_tenth", [](RunFigures& r) { r.overruns = 1'100; }, {"overrun_ratio"}},
        Bad{"cut_by_the_slew_limit", [](RunFigures& r) { r.slewed = 1; }, {"slewed_samples"}},
        Bad{"swung", [](RunFigures& r) { r.swing_s = 0.9, r.swing_hz = 7; }, {"swing_s"}},
        Bad{"hung_for_a_quarter", [](RunFigures& r) { r.silence_s = 2.5; }, {"silence_s"}},
        Bad{"lost_force_once",
            [](RunFigures& r) { r.force_losses = 1, r.force_lost_s = 0.08; },
            {"force_losses"}},
        Bad{"a_node_died_and_was_started_again",
            [](RunFigures& r) { r.restarts = 1, r.restarted = "rendering"; },
            {"restarts"}},
        Bad{"validations_4_of_500",
            [](RunFigures& r) { r.judged = r.compared = 4; },
            {"validated_ratio", "compared_ratio"}},
        Bad{"compared_a_third",
            [](RunFigures& r) { r.compared = r.judged / 3; },
            {"compared_ratio"}},
        Bad{"half_validated_and_most_of_it_compared",
            [](RunFigures& r) { r.judged = 0.55 * r.judged, r.compared = 0.85 * r.judged; },
            {"validated_ratio", "compared_ratio"}},
        Bad{"no_tool_for_two_percent",
            [](RunFigures& r) { r.not_initialised = 0.02 * r.samples; },
            {"not_initialised_ratio"}},
        Bad{"bag_of_934", [](RunFigures& r) { r.streams[0].recorded = 934; }, {"recorded_ratio"}},
        Bad{"bag_without_commands",
            [](RunFigures& r) { r.streams[2].recorded = 0, r.streams[2].first.reset(); },
            {"first_recorded_s", "recorded_ratio"}},
        Bad{"bag_that_begins_late",
            [](RunFigures& r) { r.streams[0].first = 6'000, r.streams[0].recorded = 4'000; },
            {"first_recorded_s"}},
        Bad{"never_answered",
            [](RunFigures& r) { r.first_answered.reset(), r.answered = 0; },
            {"first_answer_s", "answered_ratio"}},
        Bad{"answered_late",
            [](RunFigures& r) { r.first_answered = 6'000, r.answered = 4'000; },
            {"first_answer_s"}},
        Bad{"never_validated",
            [](RunFigures& r) { r.first_judged.reset(), r.judged = r.compared = 0; },
            {"first_validation_s", "validated_ratio", "compared_ratio"}},
        Bad{"validated_late",
            [](RunFigures& r) { r.first_judged = 7'000, r.judged = 149; },
            {"first_validation_s"}},
        Bad{"rate_that_is_none",
            [](RunFigures& r) { r.rate_hz = std::numeric_limits<double>::quiet_NaN(); },
            {"rate_ratio"}}),
    [](const auto& bad) { return std::string(bad.param.name); });

TEST(RunLimits, ReportMeasurementLimitAndStream) {
  RunFigures run = good_run();
  run.streams[1].recorded = 934;
  const auto judged = judge_figures(run, {});
  const auto found =
      std::find_if(judged.begin(), judged.end(), [](const CheckedLimit& j) { return !j.met; });
  ASSERT_NE(found, judged.end());
  EXPECT_NEAR(found->measured.value_or(0.0), 934.0 / 9'975.0, 1e-12);
  EXPECT_TRUE(sentence_of(*found).contains("0.09363 (rendering/contact)")) << sentence_of(*found);
}

TEST(RunLimits, LeaveOutClockFiguresInLockstep) {
  RunFigures run = good_run();
  run.lockstep = true;
  run.rate_hz = 100, run.overruns = 5'000, run.silence_s = 3.0, run.deadline_misses = 500,
  run.answered = 10;
  EXPECT_EQ(not_met(run), Names{});
  run.judged = 4, run.streams[0].recorded = 9'000, run.clamped = 57;
  EXPECT_EQ(not_met(run), (Names{"clamped_ratio", "validated_ratio", "recorded_ratio"}));
}

TEST(RunLimits, SkipRunsWithoutSamplesAndMissingBags) {
  RunFigures none;
  for (const CheckedLimit& judged : judge_figures(none, {}))
    EXPECT_FALSE(judged.measured) << judged.limit->name;
  EXPECT_EQ(not_met(none), Names{});
  RunFigures run = good_run();
  run.recording = false, run.streams.clear();
  EXPECT_EQ(not_met(run), Names{});
}

TEST(RunLimits, OfARunTooShortForAValidationAreMet) {
  RunFigures run = good_run();
  run.samples = 300, run.first_judged.reset(), run.judged = 0, run.excused = 0,
  run.validate_every = 1000;
  run.first_judged = 0;
  EXPECT_EQ(not_met(run), (Names{"validated_ratio"})) << "sample 0 was due";
  run.judged = 1;
  run.answered = 60, run.recording = false, run.overruns = 0;
  EXPECT_EQ(not_met(run), Names{});
}

TEST(RunLimits, AreSetByName) {
  ChosenLimits chosen;
  EXPECT_EQ(choose_limit("rate_ratio=0.5", chosen), "");
  EXPECT_EQ(choose_limit("silence_s=inf", chosen), "");
  RunFigures run = good_run();
  run.rate_hz = 600, run.silence_s = 1e9;
  EXPECT_EQ(not_met(run, chosen), Names{});
  run.rate_hz = 400;
  EXPECT_EQ(not_met(run, chosen), Names{"rate_ratio"});
}

TEST(RunLimits, RefuseInvalidLimitsWithAMessage) {
  for (const auto& [text, reason] : {std::pair{"ratio=1", "'ratio'"},
                                     {"rate_ratio", "expected NAME=VALUE"},
                                     {"rate_ratio=", "''"},
                                     {"rate_ratio=-1", "'-1'"},
                                     {"rate_ratio=nan", "'nan'"},
                                     {"rate_ratio=0.5x", "'0.5x'"},
                                     {"decided_ratio=0", "its name is compared_ratio"}}) {
    ChosenLimits chosen;
    const std::string wrong = choose_limit(text, chosen);
    EXPECT_NE(wrong.find(reason), std::string::npos) << wrong;
    EXPECT_TRUE(chosen.empty());
  }
}

/// The reference page has one row for each limit, in the same order, and no other.
TEST(RunLimits, AreThoseOfTheReferencePage) {
  std::ifstream page(VOXTOUCH_DEPLOY "/doc/reference/limits.md");
  std::vector<std::string> found, expected;
  for (std::string line; std::getline(page, line);)
    if (line.starts_with("| `"))
      found.push_back(line);
  for (const CheckedLimit& judged : judge_figures(good_run(), {})) {
    const Limit& limit = *judged.limit;
    EXPECT_FALSE(limit.what.empty() || limit.means.empty()) << limit.name;
    expected.push_back(fmt::format("| `{}`{} | {} {} | {} |", limit.name,
                                   limit.in_lockstep ? "" : "*", limit.at_least ? "≥" : "≤",
                                   with_unit(limit.value, limit.unit), limit.what));
  }
  EXPECT_EQ(found, expected);
}

}  // namespace
}  // namespace voxtouch::cli
