#include <algorithm>
#include <map>

#include "nodes/cli/up/summary.hpp"
#include "nodes/runtime/standby_options.hpp"
#include "qos/topics.hpp"

namespace voxtouch::cli {
namespace {

std::optional<double> find(const Reports& reports, const std::string& node,
                           const std::string& name) {
  const auto report = reports.find(node);
  return report == reports.end() ? std::nullopt : runtime::find_value(report->second.figures, name);
}

/// Of one stream: what its writer says that it sent, and the logger that it recorded.
RunFigures::Stream stream(const Reports& r, const qos::Topic& topic) {
  const std::string sender = qos::names_of(topic.writers).front(), key = qos::figure_name(topic);
  // What a standby sent follows on what the first one did.
  return {std::string(topic.path), find(r, "logger", key + "_first"),
          number(r, sender, "first_sample"), number(r, "logger", key + "_recorded"),
          number(r, sender, "samples") + number(r, runtime::standby_of(sender), "samples")};
}

/// Of two couplings that have both acted, the one that gave away more energy.
std::string worse_coupling(const Reports& r) {
  const std::string standby = runtime::standby_of("coupling");
  const auto lowest_j = [&](const std::string& node) {
    return std::min(number(r, node, "lowest_energy_j"),
                    number(r, node, "lowest_energy_rotation_j"));
  };
  return number(r, standby, "took_over") > 0 && lowest_j(standby) < lowest_j("coupling")
             ? standby
             : "coupling";
}

/// The longest time for which a node, or its loop, gave no sign of life; and who was silent for as
/// long as counts as hanging, the longest first.
void add_silence(const RunSummary& s, RunFigures& f) {
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

RunFigures figures_of(const RunSummary& s) {
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
  f.missed = number(r, "rendering", "missed_samples");
  f.passing = number(r, "rendering", "passing_samples");
  const std::string coupling = worse_coupling(r);
  f.lowest_energy_j = number(r, coupling, "lowest_energy_j");
  f.energy_bound_j = number(r, coupling, "energy_bound_j");
  f.lowest_energy_rotation_j = number(r, coupling, "lowest_energy_rotation_j");
  f.energy_bound_rotation_j = number(r, coupling, "energy_bound_rotation_j");
  f.validate_every = s.validate_every;
  f.first_judged = find(r, "validator", "first_checked");
  f.judged = number(r, "validator", "checked"), f.excused = number(r, "validator", "excused");
  f.recording = !s.bag.empty();
  f.streams = {stream(r, qos::kDeviceState), stream(r, qos::kContactState),
               stream(r, qos::kForceCommand)};
  add_silence(s, f);
  return f;
}

}  // namespace voxtouch::cli
