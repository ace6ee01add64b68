#include "nodes/cli/up/run_figures.hpp"

#include "qos/topics.hpp"

namespace voxtouch::cli {
namespace {

std::optional<double> find(const Reports& reports, const std::string& node, const std::string& name) {
  const auto report = reports.find(node);
  return report == reports.end() ? std::nullopt : runtime::find_value(report->second.figures, name);
}

/// Of one stream: what its writer says that it sent, and the logger that it recorded.
RunFigures::Stream stream(const Reports& r, const qos::Topic& topic) {
  const std::string sender = qos::names_of(topic.writers).front(), key = qos::figure_name(topic);
  return {std::string(topic.path), find(r, "logger", key + "_first"), number(r, sender, "first_sample"),
          number(r, "logger", key + "_recorded"), number(r, sender, "samples")};
}

}  // namespace

RunFigures figures_of(const RunSummary& s) {
  const Reports& r = s.reports;
  RunFigures f;
  f.lockstep = s.mode == "lockstep";
  f.samples = number(r, "device", "samples");
  f.nominal_rate_hz = number(r, "device", "nominal_rate_hz"), f.rate_hz = number(r, "device", "rate_hz");
  f.first_answered = find(r, "device", "first_answered");
  f.answered = number(r, "device", "answered");
  f.overruns = number(r, "device", "overruns");
  f.deadline_misses = number(r, "device", "deadline_misses");
  f.clamped = number(r, "device", "clamped");
  f.lowest_energy_j = number(r, "coupling", "lowest_energy_j");
  f.energy_bound_j = number(r, "coupling", "energy_bound_j");
  f.lowest_energy_rotation_j = number(r, "coupling", "lowest_energy_rotation_j");
  f.energy_bound_rotation_j = number(r, "coupling", "energy_bound_rotation_j");
  f.validate_every = s.validate_every;
  f.first_judged = find(r, "validator", "first_checked");
  f.judged = number(r, "validator", "checked"), f.excused = number(r, "validator", "excused");
  f.recording = !s.bag.empty();
  f.streams = {stream(r, qos::kDeviceState), stream(r, qos::kContactState), stream(r, qos::kForceCommand)};
  f.silence_s = s.silence_s, f.silent = s.silent;
  for (const auto& [node, report] : r)
    if (const double stall_s = runtime::value_of(report.figures, runtime::kLongestStall); stall_s > f.silence_s)
      f.silence_s = stall_s, f.silent = node;
  return f;
}

}  // namespace voxtouch::cli
