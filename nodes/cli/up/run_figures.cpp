#include <algorithm>
#include <map>

#include "nodes/cli/up/run_record.hpp"
#include "qos/topics.hpp"

namespace voxtouch::cli {
namespace {

std::optional<double> find(const Reports& reports, const std::string& node,
                           const std::string& name) {
  const auto report = reports.find(node);
  return report == reports.end() ? std::nullopt : runtime::find_value(report->second.figures, name);
}

/// Of one stream: samples that its writer sent and that the logger recorded.
RunFigures::Stream stream(const Reports& r, const qos::Topic& topic) {
  const std::string sender = qos::names_of(topic.writers).front(), key = qos::figure_name(topic);
  return {std::string(topic.path), find(r, "logger", key + "_first"),
          number(r, sender, "first_sample"), number(r, "logger", key + "_recorded"),
          number(r, sender, "samples")};
}

/// The longest silence of a node or its loop, and the nodes that count as hanging, the longest
/// first.
void add_silence(const RunRecord& s, RunFigures& f) {
  std::map<std::string, double> silent = s.silence_s;
  for (const auto& [node, report] : s.reports)
    silent[node] =
        std::max(silent[node], runtime::value_of(report.figures, runtime::kLongestStall));
  for (const auto& [node, time_s] : silent) {
    if (time_s > f.silence_s) {
      f.silent = node + (f.silence_s * 1e9 >= runtime::kHungNs ? ", " + f.silent : "");
      f.silence_s = time_s;
    } else if (time_s * 1e9 >= runtime::kHungNs) {
      f.silent += ", " + node;
    }
  }
}

}  // namespace

RunFigures figures_of(const RunRecord& s) {
  const Reports& r = s.reports;
  RunFigures f;
  f.lockstep = s.mode == "lockstep";
  f.samples = number(r, "device", "samples");
  f.nominal_rate_hz = number(r, "device", "nominal_rate_hz"),
  f.rate_hz = number(r, "device", "rate_hz");
  f.first_answered = find(r, "device", "first_answered");
  f.answered = number(r, "device", "answered");
  f.overruns = number(r, "device", "overruns");
  f.deadline_misses = number(r, "device", "deadline_misses");
  f.clamped = number(r, "device", "clamped");
  f.tunnelling_suspected = number(r, "rendering", "tunnelling_suspected_samples");
  f.passed_through = number(r, "rendering", "passed_through_samples");
  f.not_initialised = number(r, "rendering", "not_initialised_samples");
  f.slewed = number(r, "device", "slewed");
  f.swing_s = number(r, "coupling", "swing_s"), f.swing_hz = number(r, "coupling", "swing_hz");
  f.swing_m = number(r, "coupling", "swing_m"), f.swing_n = number(r, "coupling", "swing_n");
  f.validate_every = s.validate_every;
  f.first_judged = find(r, "validator", "first_checked");
  f.judged = number(r, "validator", "checked"), f.excused = number(r, "validator", "excused");
  f.compared = number(r, "validator", "compared");
  f.latched = number(r, "rendering", "latched_samples");
  f.recording = !s.bag.empty();
  f.streams = {stream(r, qos::kDeviceState), stream(r, qos::kContactState),
               stream(r, qos::kForceCommand)};
  add_silence(s, f);
  f.force_losses = number(r, "device", "force_losses");
  f.force_lost_s = number(r, "device", "force_lost_s"),
  f.longest_loss_s = number(r, "device", "longest_force_loss_s");
  f.start_differences = find(r, "device", "start_check_differences");
  f.start_check = word(r, "device", "start_differences");
  f.restarts = static_cast<double>(s.restarts.size());
  for (const Restart& restart : s.restarts)
    f.restarted += (f.restarted.empty() ? "" : ", ") + restart.node;
  return f;
}

}  // namespace voxtouch::cli
