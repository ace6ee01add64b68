#include "nodes/device/device_monitor.hpp"

#include <cmath>

#include <fmt/format.h>

#include "nodes/console/log.hpp"
#include "nodes/runtime/clock.hpp"

namespace voxtouch::device_node {

using runtime::NodeState;
using runtime::StatusPriority;

namespace {

std::string differing(const identification::StartFindings& findings) {
  return fmt::format(
      "the device differs from its file: {}. Its certificate does not hold; measure it again "
      "with voxtouch identify",
      identification::differences(findings));
}

}  // namespace

void LateCommands::poll(const Progress& progress, double rate_hz) {
  using enum DeviceCounter;
  const double refused = progress.counters[kRefusedLate], samples = progress.counters[kSamples];
  if (samples - samples_ < rate_hz)
    return;
  const bool late = 2.0 * (refused - late_) > samples - samples_;
  samples_ = samples, late_ = refused;
  const double met_ms = 1e-3 * progress.latency.quantile_us(0.5);
  // keep the sentence unless the delay changes by a fifth
  if (designed_ms_ > 0.0 && !lockstep_ && std::abs(met_ms - met_ms_) > 0.2 * met_ms_) {
    met_ms_ = met_ms;
    network_ = fmt::format(
        "; coupling designed for {:.4g} ms of network delay; command latency p50 {:.1f} ms, p99 "
        "{:.0f} ms",
        designed_ms_, met_ms, std::ceil(1e-3 * progress.latency.quantile_us(0.99)));
  }
  reason_.clear();
  if (late)
    reason_ = fmt::format(
        "No force: commands arrive {:.1f} ms after their samples, the design assumes {:.4g} ms of "
        "network delay. Use a faster network, or --network-delay {:.0f}",
        met_ms, designed_ms_, std::ceil(1e-3 * progress.latency.quantile_us(0.9)));
}

DeviceMonitor::DeviceMonitor(runtime::NodeHost& host, const devices::Driver& driver,
                             const bus::FollowedReader<msg::ForceCommand>& commands,
                             Progress& progress, Requests& requests, const Faults& faults,
                             double network_delay_ms)
    : host_(host),
      driver_(driver),
      commands_(commands),
      progress_(progress),
      requests_(requests),
      faults_(faults),
      coupling_("coupling", {&commands.following()}),
      reset_receiver_(host.participant(), host.options().rig),
      late_(network_delay_ms, host.options().lockstep) {}

std::string DeviceMonitor::sentence(End end) const {
  const std::string last_error = driver_.last_error(), model = driver_.description().model;
  switch (end) {
    case End::kNone:
      return "running";
    case End::kStopped:
      return "stopped on request; the device is at zero force";
    case End::kFinished:
      return "finished; the device is at zero force";
    case End::kPeersLate:
      return "not ready within 60 s: " + peers_.missing();
    case End::kPeerSilent:
      return fmt::format("no command for 5 s: {}; the device is at zero force",
                         late_peer_.empty() ? "check that the coupling node runs" : late_peer_);
    case End::kPeerGone:
      return peers_.lost() + "; the device is at zero force";
    case End::kDeviceGone:
      return fmt::format("{} does not respond; its last command was zero force: {}", model,
                         last_error.empty() ? "check its cable and power" : last_error);
    case End::kDeviceFault:
      return fmt::format(
          "{} reported a fault and needs a manual reset; it was commanded to zero force{}{}", model,
          last_error.empty() ? "" : ": ", last_error);
    case End::kRigClaimed:
      return "another device already runs in this rig; this one is at zero force. Choose another "
             "--rig or --domain";
    case End::kWriteBlocked:
      return "DDS did not accept a sample; the device is at zero force";
  }
  return "unknown";
}

void DeviceMonitor::watch(std::uint64_t session, runtime::NodeRegistry& registry) {
  coupling_.update(registry, session);
  const auto& bound = coupling_.participant();
  const runtime::NodeReport* const coupling = bound ? registry.report_of(*bound) : nullptr;
  if (coupling && coupling_faults_.is_new(*coupling))
    requests_.coupling_fault.store(true);
  reset_receiver_.receive(session, progress_.latch);
  // In a ring that was started by hand, the loss of a role ends the session.
  if (coupling_.lost_session() == session)
    peers_.lose("the coupling of this session has left");
  if (coupling && coupling->state == NodeState::kFailed && coupling->session_id == 0)
    peers_.lose("the coupling has left this session: " + coupling->message);
  peers_.update(host_, registry, session, coupling_.bound());
  if (!peers_.lost().empty())
    requests_.peer_gone.store(true);
  if (rig_.update(registry, host_.participant().guid(), progress_.latency.count()))
    requests_.rig_claimed.store(true);
}

/// Lockstep: the node that has not answered the current sample. A stalled node also delays the
/// nodes ahead of it.
std::string DeviceMonitor::find_late_peer(const runtime::NodeRegistry& registry) const {
  const double samples = progress_.counters[DeviceCounter::kSamples];
  std::string behind;
  for (const bus::Guid& partner : peers_.participants()) {
    const runtime::NodeReport* report = registry.report_of(partner);
    if (!report)
      continue;
    if (const double stalled_s = runtime::value_of(report->figures, runtime::kStalledFor);
        stalled_s > 0.0)
      return fmt::format("{} is stalled for {:.1f} s and blocks the other nodes", report->node,
                         stalled_s);
    const bool answers = report->node == "rendering" || report->node == "coupling";
    if (answers && runtime::value_of(report->figures, "samples") <= samples &&
        behind != "rendering")
      behind = report->node;
  }
  return behind.empty() ? "" : fmt::format("{} has not answered sample {:.0f}", behind, samples);
}

/// Reports the driver's last error, or else its kind, or how long the process was suspended.
void DeviceMonitor::note_error(End end) {
  if (end == End::kNone && progress_.has_error.load()) {
    const std::string text = driver_.last_error();
    diagnostic_ = !text.empty() ? text
                                : fmt::format("the last driver call returned '{}'",
                                              devices::name_of(progress_.last_error.load()));
  }
  const double gap_ms = progress_.counters[DeviceCounter::kLongestGap];
  if (gap_ms > reported_gap_ms_) {
    reported_gap_ms_ = gap_ms;
    diagnostic_ = fmt::format("the device process stalled for {:.0f} ms", gap_ms);
  }
}

void DeviceMonitor::report_to(std::uint64_t session, runtime::NodeRegistry& registry,
                              runtime::NodeReport& report, runtime::StatusText& status) {
  const End end = progress_.end.load(std::memory_order_acquire);
  watch(session, registry);
  note_error(end);
  late_.poll(progress_, driver_.description().rate_hz);
  if (host_.options().lockstep && end == End::kNone)
    late_peer_ = find_late_peer(registry);
  const bool running = progress_.started_ns.load() != 0, ended = end != End::kNone;
  report.session_id = session;
  report.lockstep_peers = peers_.participants();
  report.state = !ended ? (running ? NodeState::kRunning : NodeState::kReady)
                        : (end == End::kStopped || end == End::kFinished ? NodeState::kStopped
                                                                         : NodeState::kFailed);
  const std::string missing = peers_.missing();
  status.set(StatusPriority::kProgress,
             running ? "running" + late_.network()
                     : "waiting for " + (missing.empty() ? "the coupling design" : missing));
  status.set(StatusPriority::kForeign, coupling_.diagnostic(registry));
  if (!rig_.conflicting().empty())
    status.set(StatusPriority::kConflict,
               "another device runs in this rig; one of the two will stop: " + rig_.conflicting());
  status.set(StatusPriority::kNetwork, late_.reason());
  if (progress_.has_error.load())
    status.set(StatusPriority::kFault,
               fmt::format("{} is at zero force: {}", driver_.description().model, diagnostic_));
  if (ended)
    status.set(StatusPriority::kEnded, sentence(end));
  fill(report);
  judge_start(report, status);
  progress_.latch.report_to(report, !ended);
  status.set(StatusPriority::kFaultLatched, std::exchange(report.message, {}));
}

/// The result of the check at start, for a device with a measured file.
void DeviceMonitor::judge_start(runtime::NodeReport& report, runtime::StatusText& status) {
  if (!start_ && progress_.start_checked.load(std::memory_order_acquire)) {
    start_ = progress_.start_check.findings();
    if (start_->differs())
      console::log("warning: device: {}\n", differing(*start_));
  }
  if (!start_) {
    if (progress_.start_check.started())
      report.values["start_check"] = "not finished: it needs a second with force";
    return;
  }
  report.values["start_check"] = to_text(*start_);
  report.values["start_differences"] = identification::differences(*start_);
  report.figures["start_check_differences"] = {
      static_cast<double>(identification::count_differences(*start_)), "figures"};
  if (start_->differs())
    status.set(StatusPriority::kNetwork, differing(*start_));
}

void DeviceMonitor::fill(runtime::NodeReport& report) {
  report.values["device"] = driver_.description().model;
  report.values["last_error"] = diagnostic_;
  report.values["foreign_writers"] = coupling_.refused_writers();
  // lockstep runs must not depend on a clock
  const bool timed = !host_.options().lockstep;
  const std::int64_t started = progress_.started_ns.load(), ended = progress_.ended_ns.load();
  const std::int64_t until = ended ? ended : runtime::monotonic_ns();
  const double elapsed_s = started ? static_cast<double>(until - started) * 1e-9 : 0.0;
  const double samples = progress_.counters[DeviceCounter::kSamples],
               own_rate_hz = driver_.description().rate_hz;
  const auto latency_us = [&](double us) {
    return runtime::Figure(timed ? std::round(us) : 0.0, "us");
  };
  last_second_.poll(runtime::monotonic_ns(), static_cast<std::uint64_t>(samples),
                    progress_.latency.count(),
                    progress_.counters.take(DeviceCounter::kRecentForce));
  report.figures = {{"nominal_rate_hz", {own_rate_hz, "Hz"}},
                    {"last_second_max_force_n", {last_second_.largest_force_n(), "N"}},
                    {"last_second_answered_ratio", {last_second_.answered_ratio(), "1"}},
                    {"rate_hz", {timed && elapsed_s > 0 ? samples / elapsed_s : own_rate_hz, "Hz"}},
                    {"latency_p50_us", latency_us(progress_.latency.quantile_us(0.5))},
                    {"latency_p99_us", latency_us(progress_.latency.quantile_us(0.99))},
                    {"latency_max_us", latency_us(progress_.latency.max_us())},
                    {"answered", {progress_.latency.count(), "samples"}},
                    {"foreign_commands", {coupling_.refused(), "commands"}}};
  progress_.counters.report_to(report.figures);
  report.figures["refused"].value += static_cast<double>(coupling_.refused());
  if (!ended)
    report.figures["deadline_misses"].value = static_cast<double>(commands_.deadlines_missed());
  faults_.report_to(report);
  rig_.report_to(report);
}

}  // namespace voxtouch::device_node
