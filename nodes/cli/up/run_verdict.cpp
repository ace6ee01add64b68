#include "nodes/cli/up/run_verdict.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "nodes/faults/fault_latch.hpp"

namespace voxtouch::cli {
namespace {

/// Noted if it holds in more than `most` samples of the rendering.
struct SampleNote {
  const char* figure;
  double most;
  const char* what;
  bool with_virtual_tool = true;
};
constexpr SampleNote kSampleNotes[] = {
    {"fully_inside_samples", 100,
     "the tool was fully inside a static object, without a contact direction; check the motion's "
     "start"},
    {"not_initialised_samples", 100,
     "the virtual tool was not initialised: the hand was inside an object, or the coupling design "
     "was running"},
    {"not_converged_samples", 0,
     "the virtual tool had not converged: the hand or an object was too fast, or too many features "
     "touched at once"},
    {"saturated_samples", 0,
     "the force was saturated: use more stiffness, a thicker body or a stronger device", false},
};

class VerdictRules {
 public:
  explicit VerdictRules(const RunRecord& run) : run_(run) {}

  RunVerdict verdict() && {
    for (const Found& event : run_.events)
      put(event);
    nodes();
    unauthorised();
    force();
    recording();
    out_.limits = judge_figures(figures_of(run_), run_.limits);
    // Both counts of a ratio belong to one run only if it is at most 1. The rate is measured by
    // another clock. Without the device's last word its counts are known to be behind.
    const auto device = run_.reports.find("device");
    if (device != run_.reports.end() && device->second.final())
      for (const CheckedLimit& one : out_.limits)
        if (one.limit->at_least && one.limit->unit == "1" && one.measured &&
            *one.measured > (one.limit->name == "rate_ratio" ? 1.05 : 1.0 + 1e-9))
          put({RunFact::kRatioAboveOne, std::string(one.limit->name), *one.measured});
    notes();
    return std::move(out_);
  }

 private:
  double count(const char* node, const char* figure) const {
    return number(run_.reports, node, figure);
  }
  std::string message(const std::string& node) const {
    const auto report = run_.reports.find(node);
    return report == run_.reports.end() ? "" : report->second.message;
  }
  void put(Found found) {
    (found.what < RunFact::kInterrupted ? out_.faults : out_.notes).push_back(std::move(found));
  }
  void put_count(RunFact what, const char* node, const char* figure, std::string text = {}) {
    if (const double n = count(node, figure); n > 0)
      put({what, node, n, 0.0, std::move(text)});
  }

  /// Figures of a node without a final status are those of some time before the end.
  void nodes() {
    for (const std::string& node : run_.started) {
      const auto report = run_.reports.find(node);
      const bool is_reported =
          std::ranges::any_of(run_.events, [&](const Found& event) { return event.node == node; });
      if (is_reported || (report != run_.reports.end() && report->second.final()))
        continue;
      put({RunFact::kNoFinalStatus, node, count(node.c_str(), "samples")});
    }
    put_count(RunFact::kDisagree, "validator", "disagree", message("validator"));
  }

  void unauthorised() {
    std::string names;
    for (const UnauthorisedWriter& one : run_.unauthorised) {
      if (one.recovers > 0)
        put({RunFact::kRecovers, "", one.recovers, 0.0, one.name});
      std::string topics;
      for (const std::string& topic : one.topics)
        topics += (topics.empty() ? " on " : ", ") + topic;
      if (!topics.empty())
        names += (names.empty() ? "" : "; ") + one.name + topics;
    }
    const double refused = count("device", "foreign_commands") +
                           count("coupling", "foreign_samples") +
                           count("rendering", "foreign_samples");
    if (refused > 0)
      put({RunFact::kForeignSamples, "", refused, 0.0, refusals()});
    if (!names.empty())
      put({RunFact::kForeignWriters, "", 0.0, 0.0, names});
    if (const double n = count("logger", "refused_records") + count("logger", "skipped_messages");
        n > 0)
      put({RunFact::kForeignRecords, "logger", n, 0.0,
           word(run_.reports, "logger", "refused_writers")});
    double statuses = run_.refused_statuses;
    for (const auto& [node, report] : run_.reports)
      statuses = std::max(statuses, count(node.c_str(), "refused_statuses"));
    if (statuses > 0)
      put({RunFact::kRefusedStatuses, "", statuses, 0.0, run_.refused_writers});
  }

  /// Refused samples, by node and participant.
  std::string refusals() const {
    std::string all;
    for (const char* node : {"device", "coupling", "rendering"})
      if (const std::string of = word(run_.reports, node, "foreign_writers"); !of.empty())
        all += fmt::format("{}{} refused {}", all.empty() ? "" : "; ", node, of);
    return all.empty() ? message("device") : all;
  }

  void force() {
    for (const char* node : {"device", "coupling"})
      put_count(RunFact::kFaultLatched, node, faults::FaultLatch::kCount);
    const double displayed = count("coupling", "stiffness_at_hand_n_per_m"),
                 most = count("coupling", "device_max_stiffness_n_per_m");
    if (most > 0 && displayed > most)
      put({RunFact::kTooStiff, "", displayed, most});
    const double samples = count("device", "samples"),
                 without = count("device", "zero_force_samples"),
                 times = count("device", "interruptions");
    if (samples == 0 && out_.faults.empty())
      put({RunFact::kNoSample});
    const std::string reason = word(run_.reports, "device", "last_error");
    if (without > 0 && without >= samples)
      put({RunFact::kNoForce, "device", without, 0.0, reason});
    else if (times > 0)
      put({RunFact::kInterrupted, "device", without, times, reason});
  }

  void recording() {
    if (!run_.recorded)
      return;
    for (const std::string& loss : run_.recorded->losses)
      put({RunFact::kLostRecording, "logger", 0.0, 0.0, loss});
    const double written = count("logger", "written"),
                 held = static_cast<double>(run_.recorded->messages);
    const bool one_bag = std::ranges::none_of(
        run_.restarts, [](const Restart& one) { return one.node == "logger"; });
    if (one_bag && run_.recorded->losses.empty() && held < written)
      put({RunFact::kLostRecording, "logger", held, written});
  }

  void notes() {
    if (const std::string about = word(run_.reports, "rendering", "external"); !about.empty())
      put({RunFact::kExternal, "rendering", 0.0, 0.0, about});
    for (const SampleNote& note : kSampleNotes)
      if (const double n = count("rendering", note.figure);
          n > note.most && (note.with_virtual_tool || !has_virtual_tool(run_)))
        put({RunFact::kSamples, "rendering", n, 0.0, note.what});
    if (const std::string found = word(run_.reports, "device", "start_check"); !found.empty())
      put({RunFact::kStartCheck, "device", 0.0, 0.0, found});
    put_count(RunFact::kChanges, "rendering", "changes",
              word(run_.reports, "rendering", "change_requests"));
    for (const Restart& one : run_.restarts)
      put({RunFact::kRestarted, one.node, one.at_sample, one.is_done ? 1.0 : 0.0, one.how});
    for (const std::string& record : run_.fault_records)
      put({RunFact::kFaultRecord, "", 0.0, 0.0, record});
  }

  const RunRecord& run_;
  RunVerdict out_;
};

}  // namespace

std::size_t RunVerdict::limits_failed() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(limits, [](const CheckedLimit& one) { return !one.met; }));
}
bool RunVerdict::passed() const { return faults.empty() && limits_failed() == 0; }

RunVerdict judge(const RunRecord& run) { return VerdictRules(run).verdict(); }

}  // namespace voxtouch::cli
