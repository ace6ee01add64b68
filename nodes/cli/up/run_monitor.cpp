#include "nodes/cli/up/run_monitor.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "nodes/cli/up/process_supervisor.hpp"
#include "nodes/cli/up/summary.hpp"
#include "nodes/console/log.hpp"
#include "nodes/faults/fault_latch.hpp"
#include "nodes/runtime/clock.hpp"

namespace voxtouch::cli {

namespace {

constexpr std::string_view kPage = "page";

}  // namespace

RunMonitor::RunMonitor(const bus::Participant& participant, const std::string& rig,
                       bus::RosGraph graph, StartReport start)
    : registry_(participant, rig),
      own_(participant.guid()),
      verdicts_(participant, qos::kValidation, rig, qos::profile(qos::ProfileId::kTap)),
      writers_(participant, rig),
      ros_(participant),
      graph_(graph),
      start_(std::move(start)) {}

void RunMonitor::poll(const ProcessSupervisor& nodes) {
  // No node is watched while `up` itself was suspended.
  const std::int64_t now_ns = runtime::monotonic_ns();
  if (last_poll_ns_ != 0)
    silence_s_["up"] =
        std::max(silence_s_["up"], 1e-9 * static_cast<double>(now_ns - last_poll_ns_));
  last_poll_ns_ = now_ns;
  const auto is_of_node = [&](const runtime::NodeReport& report) {
    const RunningNode* const node = report.node == kPage ? page_ : nodes.find(report.node);
    if (!node || node->pid() != report.pid)
      return false;
    // Any participant can copy the process number in a status: the first one that had it is kept.
    return plays_.try_emplace(report.node, report.participant).first->second == report.participant;
  };
  registry_.update(is_of_node);
  verdicts_.take_each([](const msg::ValidationReport&) {});
  writers_.poll(registry_);
  ros_.poll();
  for (const runtime::NodeReport& report : registry_.reports()) {
    if (!is_of_node(report))
      continue;
    players_[report.node].insert(report.participant);
    if (report.node == kPage)
      continue;
    const auto earlier = earlier_.find(report.node);
    reports_[report.node] =
        earlier == earlier_.end() ? report : over_all_processes(earlier->second, report);
    if (report.final() || !nodes.is_running(report.node))
      continue;
    double& longest_s = silence_s_[report.node];
    longest_s = std::max(longest_s, registry_.silent_s(report));
  }
}

bool RunMonitor::is_ready(const std::string& node) const {
  const auto report = reports_.find(node);
  return report != reports_.end() && report->second.state == runtime::NodeState::kReady;
}

std::optional<std::string> RunMonitor::watch(const ProcessSupervisor& nodes) {
  for (const std::string& line : start_.poll(reports_))
    console::log("{}\n", line);
  std::set<std::string> still;
  for (const runtime::Hung& hung : registry_.hung()) {
    const auto ours = reports_.find(hung.node);
    if (ours == reports_.end() || ours->second.participant != hung.participant ||
        !nodes.is_running(hung.node))
      continue;
    still.insert(hung.node);
    if (hanging_.insert(hung.node).second)
      console::log("  {}\n", hung.sentence);
    if (hung.for_s * 1e9 >= static_cast<double>(runtime::kGivenUpNs))
      return hung.node;
  }
  std::erase_if(hanging_, [&](const std::string& name) {
    if (still.contains(name))
      return false;
    console::log("  {} is alive again\n", name);
    return true;
  });
  return std::nullopt;
}

void RunMonitor::log_once(const std::string& node, const std::string& text) {
  if (std::exchange(printed_[node], text) != text && !text.empty())
    console::log("  {}: {}\n", node, text);
}

void RunMonitor::print(const ProcessSupervisor& nodes) {
  console::log("{}\n", status_line(reports_, nodes.names()));
  log_once("warning", ros_.mismatch(graph_));
  const auto message = [this](const char* node) {
    const auto report = reports_.find(node);
    return report == reports_.end() ? "" : report->second.message;
  };
  if (!word(reports_, "coupling", faults::FaultLatch::kNumber).empty())
    log_once("coupling", message("coupling"));
  if (number(reports_, "logger", "dropped") > 0)
    log_once("logger", message("logger"));
  const std::string writer = word(reports_, "rendering", "external_writer");
  if (!writer.empty() || printed_.contains("rendering"))
    log_once("rendering", fmt::format("the external wrench on {} {}",
                                      word(reports_, "rendering", "external_topic"),
                                      writer.empty() ? "has no writer" : "comes from " + writer));
  const auto device = reports_.find("device");
  if (device == reports_.end() || device->second.state != runtime::NodeState::kRunning ||
      !hanging_.empty())
    return;
  log_once("device", device->second.message == "running" ? "" : device->second.message);
}

double RunMonitor::silent_s(const std::string& node) const {
  const auto report = reports_.find(node);
  return report == reports_.end() ? 0.0 : registry_.silent_s(report->second);
}

void RunMonitor::forget(const std::string& node) {
  if (const auto last = reports_.extract(node))
    earlier_[node] = last.mapped();
  plays_.erase(node);
  hanging_.erase(node);
}

bool RunMonitor::last_process_is_here(const std::string& node) const {
  const auto earlier = earlier_.find(node);
  return earlier != earlier_.end() && registry_.is_here(earlier->second.participant);
}

std::string RunMonitor::taken_by(const std::string& node) const {
  for (const runtime::NodeReport& other : registry_.reports())
    if (other.node == node && !other.final() && registry_.is_here(other.participant))
      return fmt::format("process {} on {}", other.pid, other.host);
  return "";
}

void RunMonitor::report_to(RunRecord& run) const {
  run.reports = reports_, run.silence_s = silence_s_;
  for (const auto& [name, report] : earlier_)
    run.reports.emplace(name, report);  // without a status of its last process
  std::set<bus::Guid> own{own_};
  for (const auto& [node, participants] : players_)
    own.insert(participants.begin(), participants.end());
  run.unauthorised = writers_.found(own);
  run.refused_statuses = static_cast<double>(registry_.refused());
  for (const bus::Guid& one : registry_.refused_participants())
    run.refused_writers += (run.refused_writers.empty() ? "" : ", ") + registry_.name_of(one);
}

}  // namespace voxtouch::cli
