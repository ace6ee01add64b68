// The verdict on records that are made up.
#include "nodes/cli/up/run_verdict.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <sstream>

#include <nlohmann/json.hpp>

#include "nodes/cli/up/summary.hpp"
#include "nodes/cli/up/verdict_text.hpp"

namespace voxtouch::cli {
namespace run_verdict_test {

using runtime::NodeState;

runtime::NodeReport final_report(const std::string& node, runtime::Figures figures) {
  runtime::NodeReport report;
  report.node = node, report.state = NodeState::kStopped, report.figures = std::move(figures);
  return report;
}

/// Ten seconds as they should be.
RunRecord good_run() {
  RunRecord run;
  run.scene = "cup", run.device = "sim-phantom", run.mode = "real time", run.bag = "bag";
  run.validate_every = 20;
  const auto add = [&](const std::string& node, runtime::Figures figures) {
    run.reports[node] = final_report(node, std::move(figures));
  };
  add("device", {{"samples", {10'000, "samples"}},
                 {"nominal_rate_hz", {1000, "Hz"}},
                 {"rate_hz", {1000.4, "Hz"}},
                 {"answered", {9'752, "samples"}},
                 {"first_answered", {240, "sample number"}}});
  add("rendering", {{"samples", {9'975, "samples"}}, {"first_sample", {25, "sample number"}}});
  add("coupling", {{"samples", {9'760, "samples"}}, {"first_sample", {240, "sample number"}}});
  add("validator", {{"checked", {485, "samples"}},
                    {"compared", {480, "samples"}},
                    {"first_checked", {300, "sample number"}}});
  runtime::Figures recorded{{"written", {30'000, "messages"}}};
  for (const auto& [stream, first, count] : {std::tuple{"device_state", 0, 10'000},
                                             {"rendering_contact", 25, 9'975},
                                             {"coupling_command", 240, 9'760}}) {
    recorded[std::string(stream) + "_first"] = {first, "sample number"};
    recorded[std::string(stream) + "_recorded"] = {count, "samples"};
  }
  add("logger", std::move(recorded));
  for (const auto& [node, report] : run.reports)
    run.started.insert(node);
  run.recorded = BagState{30'000, {}};
  return run;
}

/// The line of `text` that begins with `name`.
std::string row(const std::string& text, const std::string& name) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.contains("  " + name))
      return line;
  return "";
}

TEST(RunSummary, HasFifteenLinesOfAHundredColumns) {
  RunSummary run;
  static_cast<RunRecord&>(run) = good_run();
  run.reports["rendering"].figures["spring_n_per_m"] = {518, "N/m"};
  run.reports["coupling"].values["design_status"] = "as_requested";
  run.verdict = judge(run);
  std::istringstream lines(to_text(run));
  std::size_t number_of_lines = 0;
  for (std::string line; std::getline(lines, line); ++number_of_lines)
    EXPECT_LE(line.size(), 100u) << line;
  EXPECT_LE(number_of_lines, 16u) << to_text(run);
}

TEST(RunSummary, HasNoBoundForALimitThatIsLifted) {
  RunSummary run;
  static_cast<RunRecord&>(run) = good_run();
  EXPECT_TRUE(choose_limit("overrun_ratio=inf", run.limits).empty());
  run.verdict = judge(run);
  EXPECT_TRUE(row(to_text(run), "answered ratio").contains(">= 0.95")) << to_text(run);
  EXPECT_FALSE(row(to_text(run), "overrun ratio").contains("inf")) << to_text(run);
}

TEST(RunSummary, StatesThatLockstepMeasuresNoLatency) {
  RunSummary run;
  static_cast<RunRecord&>(run) = good_run();
  run.reports["device"].figures["latency_p50_us"] = {170, "us"};
  EXPECT_TRUE(row(to_text(run), "latency p50").contains(" 170 us")) << to_text(run);
  EXPECT_EQ(to_json(run)["ring_latency_us"]["p50"], 170.0);
  run.mode = "lockstep";
  run.reports["device"].figures["latency_p50_us"] = {0, "us"};
  EXPECT_TRUE(row(to_text(run), "latency p50").contains("  -  ")) << to_text(run);
  EXPECT_TRUE(to_json(run)["ring_latency_us"]["p50"].is_null());
}

TEST(RunVerdict, IsPassedForAHealthyRun) {
  const RunRecord run = good_run();
  const RunVerdict verdict = judge(run);
  EXPECT_TRUE(verdict.passed()) << ::testing::PrintToString(problems_of(run, verdict));
  EXPECT_TRUE(verdict.notes.empty()) << ::testing::PrintToString(notes_of(run, verdict));
  EXPECT_EQ(verdict_line(run, verdict), "PASSED");
}

struct Case {
  const char* name;
  RunFact fact;
  std::function<void(RunRecord&)> change;
  const char* words;  ///< of its sentence
};
void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }
void set(RunRecord& run, const char* node, const char* figure, double value) {
  run.reports[node].figures[figure] = {value, ""};
}

class Fails : public testing::TestWithParam<Case> {};
TEST_P(Fails, WithTheReason) {
  RunRecord run = good_run();
  GetParam().change(run);
  const RunVerdict verdict = judge(run);
  EXPECT_FALSE(verdict.passed());
  EXPECT_EQ(std::ranges::count(verdict.faults, GetParam().fact, &Found::what), 1);
  const std::vector<std::string> problems = problems_of(run, verdict);
  EXPECT_TRUE(std::ranges::any_of(problems, [&](const std::string& one) {
    return one.contains(GetParam().words);
  })) << ::testing::PrintToString(problems);
  EXPECT_TRUE(verdict_line(run, verdict).starts_with("FAILED (")) << verdict_line(run, verdict);
}
INSTANTIATE_TEST_SUITE_P(
    RunVerdict, Fails,
    testing::Values(
        Case{"a_node_whose_last_word_never_came", RunFact::kNoFinalStatus,
             [](RunRecord& r) { r.reports["coupling"].state = NodeState::kRunning; },
             "no final status from coupling"},
        Case{"a_node_that_said_nothing_at_all", RunFact::kNoFinalStatus,
             [](RunRecord& r) { r.started.insert("other"); }, "other"},
        Case{"more_samples_validated_than_were_due", RunFact::kRatioAboveOne,
             [](RunRecord& r) { set(r, "validator", "checked", 1630); },
             "validated_ratio is 3.361"},
        Case{"more_samples_answered_than_were_given", RunFact::kRatioAboveOne,
             [](RunRecord& r) { set(r, "device", "answered", 9'900); }, "answered_ratio"},
        Case{"more_samples_recorded_than_were_sent", RunFact::kRatioAboveOne,
             [](RunRecord& r) {
               set(r, "device", "samples", 9'000), set(r, "logger", "device_state_recorded", 9'000),
                   set(r, "device", "answered", 8'000), set(r, "validator", "compared", 400);
             },
             "validated_ratio"},
        Case{"a_rate_of_another_clock", RunFact::kRatioAboveOne,
             [](RunRecord& r) { set(r, "device", "rate_hz", 1'100); }, "rate_ratio"},
        Case{"a_bag_whose_file_is_gone", RunFact::kLostRecording,
             [](RunRecord& r) {
               r.recorded = BagState{
                   0, {"'bag/bag_0.mcap' is missing in the recording: 30000 messages are lost."}};
             },
             "is missing"},
        Case{"a_bag_that_holds_less_than_was_written", RunFact::kLostRecording,
             [](RunRecord& r) { r.recorded->messages = 15'000; }, "15000 of 30000"},
        Case{"foreign_samples", RunFact::kForeignSamples,
             [](RunRecord& r) {
               set(r, "coupling", "foreign_samples", 724);
               r.reports["coupling"].values["foreign_writers"] =
                   "721 of rendering (process 7 on host) and 3 of ROS 2's /player";
             },
             "724 samples of another writer on the ring's topics were refused (coupling refused "
             "721 of rendering (process 7 on host) and 3 of ROS 2's /player)"},
        Case{"foreign_descriptions", RunFact::kForeignSamples,
             [](RunRecord& r) { set(r, "rendering", "foreign_samples", 3); }, "3 samples"},
        Case{"a_fault_latch", RunFact::kFaultLatched,
             [](RunRecord& r) { set(r, "coupling", "fault_latches", 1); }, "the coupling latched"},
        Case{"a_node_killed", RunFact::kNodeEnded,
             [](RunRecord& r) {
               r.events.push_back({RunFact::kNodeEnded, "rendering", 137});
             },
             "rendering ended by signal 9"}),
    [](const auto& one) { return std::string(one.param.name); });

/// Two reasons for one fault would hide the remedy.
TEST(RunVerdict, KilledNodeNeedsNoFinalReport) {
  RunRecord run = good_run();
  run.reports["rendering"].state = NodeState::kRunning;
  run.events.push_back({RunFact::kNodeEnded, "rendering", 137});
  EXPECT_EQ(problems_of(run, judge(run)).size(), 1U);
}

TEST(RunVerdict, NamesFadesAndFaultRecordsInItsLine) {
  RunRecord run = good_run();
  set(run, "device", "faded", 3);
  run.fault_records = {"a", "b", "c", "d", "e", "f"};
  EXPECT_EQ(verdict_line(run, judge(run)), "PASSED (3 force fades, 6 fault records)");
  set(run, "device", "force_losses", 3), set(run, "device", "force_lost_s", 0.24),
      set(run, "device", "longest_force_loss_s", 0.08);
  EXPECT_EQ(verdict_line(run, judge(run)),
            "FAILED (1 of 20 limits, 3 force fades, 6 fault records)");
  EXPECT_TRUE(
      problems_of(run, judge(run)).front().contains("3 times (0.24 s in total, longest 0.08 s)"))
      << problems_of(run, judge(run)).front();
}

TEST(RunVerdict, FailsIfUpItselfStalled) {
  RunRecord run = good_run();
  run.silence_s = {{"device", 0.1}, {"up", 1.2}};
  const RunVerdict verdict = judge(run);
  EXPECT_EQ(verdict.limits_failed(), 1U);
  EXPECT_TRUE(problems_of(run, verdict).front().contains("1.2 s (up)"))
      << problems_of(run, verdict).front();
}

TEST(RunVerdict, NotesHarmlessForeignTraffic) {
  RunRecord run = good_run();
  set(run, "rendering", "changes", 1);
  run.reports["rendering"].values["change_requests"] = "2 of ROS 2's /tuner";
  set(run, "device", "refused_statuses", 12);
  run.unauthorised = {{"tool (process 8 on host)", {"device/description"}, 1625}};
  const RunVerdict verdict = judge(run);
  EXPECT_TRUE(verdict.passed());
  const std::string notes = ::testing::PrintToString(notes_of(run, verdict));
  for (const char* words :
       {"during the run: 1;", "requests by: 2 of ROS 2's /tuner", "12 node statuses",
        "1625 Recover messages from tool (process 8 on host)", "on device/description"})
    EXPECT_TRUE(notes.contains(words)) << notes;
}

TEST(RunVerdict, OfARestartedLoggerCountsNoMessagesOfTheFirstBag) {
  RunRecord run = good_run();
  run.restarts = {{"logger", "signal 9", 500, true}};
  run.limits["restarts"] = 1;
  run.recorded->messages = 15'000;
  EXPECT_TRUE(judge(run).passed());
}

}  // namespace run_verdict_test
}  // namespace voxtouch::cli
