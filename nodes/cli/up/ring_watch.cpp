// What a run sees while its nodes run, and what it says of it at once.
#include <unistd.h>

#include <algorithm>
#include <thread>

#include <fmt/format.h>

#include "nodes/cli/up/ring_run.hpp"
#include "nodes/faults/force_lock.hpp"
#include "nodes/log/tell.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/signals.hpp"
#include "nodes/runtime/standby.hpp"

namespace voxtouch::cli {
namespace {

std::string how_ended(const std::string& name, int status) {
  return fmt::format("{} was ended by {}", name,
                     status > 128 ? fmt::format("signal {}", status - 128)
                                  : fmt::format("itself, with status {}", status));
}

}  // namespace

void RingRun::watch() {
  std::int64_t next_line = runtime::monotonic_ns();
  while (!runtime::stop_requested().load()) {
    listen();
    if (runtime::monotonic_ns() >= next_line) {
      log::tell("{}\n", status_line(summary_.reports, names()));
      tell_trouble();
      next_line += 1'000'000'000;
    }
    bool over = watch_for_hung();
    watch_pairs();
    for (const auto& child : children_)
      if (const auto status = child->ended()) {
        if (goes_on_without(child->name())) {
          note_loss(child->name(), how_ended(child->name(), *status));
          continue;
        }
        if (child->name() != "device" || *status != 0)
          note_end(child->name(), *status);
        over = true;
      }
    if (over || note_refusals())
      return let_guard_act();
    usleep(kWatchPeriodUs);  // ended at once by a signal: Ctrl-C, or that a node has died
  }
  // Where this process had to wait for its turn, a node may have been lost that it has not looked
  // at since.
  for (const auto& child : children_)
    if (const auto status = child->ended();
        status && *status > 128 && goes_on_without(child->name()))
      note_loss(child->name(), how_ended(child->name(), *status));
  log::tell("stopping\n");
  if (const double duration_s = options_.ring.device.duration_s; duration_s > 0)
    summary_.problems.push_back(
        fmt::format("the run was stopped before its {} s were over", duration_s));
}

void RingRun::let_guard_act() {
  if (is_running("device"))
    std::this_thread::sleep_for(kGuardActs);
}

void RingRun::listen() {
  registry_.update([this](const runtime::NodeReport& report) { return is_child(report); });
  verdicts_.take_each([](const msg::ValidationReport&) {});
  for (const runtime::NodeReport& report : registry_.reports())
    if (is_child(report))
      summary_.reports[report.node] = report;
}

bool RingRun::watch_for_hung() {
  for (const auto& [name, report] : summary_.reports) {
    if (report.final() || !is_running(name))
      continue;
    double& longest_s = summary_.silence_s[name];
    longest_s = std::max(longest_s, registry_.silent_s(report));
  }
  std::set<std::string> still;
  for (const runtime::Hung& hung : registry_.hung()) {
    const auto ours = summary_.reports.find(hung.node);
    if (ours == summary_.reports.end() || ours->second.participant != hung.participant ||
        !is_running(hung.node))
      continue;
    still.insert(hung.node);
    if (hanging_.insert(hung.node).second)
      log::tell("  {}\n", hung.sentence);
    if (hung.for_s * 1e9 < static_cast<double>(runtime::kGivenUpNs))
      continue;
    if (goes_on_without(hung.node)) {
      note_loss(hung.node, fmt::format("{} has given no sign of life for {} s", hung.node,
                                       runtime::kGivenUpNs / 1'000'000'000));
      continue;
    }
    summary_.problems.push_back(
        fmt::format("{} has given no sign of life for {} s: the run ends without it", hung.node,
                    runtime::kGivenUpNs / 1'000'000'000));
    return true;
  }
  std::erase_if(hanging_, [&](const std::string& name) {
    if (still.contains(name))
      return false;
    log::tell("  {} is heard again\n", name);
    return true;
  });
  return false;
}

void RingRun::watch_pairs() {
  for (const char* role : {"rendering", "coupling"})
    for (const std::string& name : {std::string(role), runtime::standby_of(role)}) {
      const auto count = runtime::as_count(number(summary_.reports, name, "took_over"));
      if (const auto known = summary_.takeovers.find(name);
          count == 0 || (known != summary_.takeovers.end() && count <= known->second))
        continue;
      summary_.takeovers[name] = count;
      log::tell("  {} took over at sample {:.0f}\n", name,
                number(summary_.reports, name, "took_over_at"));
    }
}

void RingRun::tell_trouble() {
  if (const auto coupling = summary_.reports.find("coupling");
      coupling != summary_.reports.end() &&
      coupling->second.values.contains(faults::ForceLock::kNumber)) {
    if (locked_.insert(coupling->second.values.at(faults::ForceLock::kNumber)).second)
      log::tell("  coupling: {}\n", coupling->second.message);
  }
  if (const std::string writer = word(summary_.reports, "rendering", "external_writer");
      writer != external_writer_) {
    log::tell("  rendering: the outside wrench on {} {}\n",
              word(summary_.reports, "rendering", "external_topic"),
              writer.empty() ? "comes from nobody any more" : "comes from " + writer);
    external_writer_ = writer;
  }
  const auto report = summary_.reports.find("device");
  if (report == summary_.reports.end() || report->second.state != runtime::NodeState::kRunning)
    return;
  const std::string& message = report->second.message;
  if (message == last_message_ || !hanging_.empty())
    return;  // who hangs has been named
  if (message != "running")
    log::tell("  device: {}\n", message);
  last_message_ = message;
}

bool RingRun::note_refusals() {
  bool any = false;
  for (const auto& [name, report] : summary_.reports)
    if (report.state == runtime::NodeState::kFailed && name != "device" &&
        noted_.insert(name).second) {
      summary_.problems.push_back(name + ": " + report.message);
      any = true;
    }
  return any;
}

void RingRun::note_loss(const std::string& name, const std::string& how) {
  if (!noted_.insert(name).second)
    return;
  const bool acts = word(summary_.reports, partner_of(name), runtime::kDuty) == runtime::kActs;
  const std::string sentence = fmt::format("{}; {} {}", how, partner_of(name),
                                           acts || name == runtime::standby_of(partner_of(name))
                                               ? "goes on"
                                               : "stood by, and takes over");
  log::tell("  {}\n", sentence);
  summary_.problems.push_back(sentence);
}

std::string RingRun::partner_of(const std::string& name) const {
  if (!options_.standby)
    return {};
  for (const char* role : {"rendering", "coupling"}) {
    if (name == role)
      return runtime::standby_of(role);
    if (name == runtime::standby_of(role))
      return role;
  }
  return {};
}

bool RingRun::goes_on_without(const std::string& name) {
  const std::string partner = partner_of(name);
  if (partner.empty() || !is_running(partner))
    return false;
  const auto report = summary_.reports.find(partner);
  return report != summary_.reports.end() && !report->second.final() &&
         report->second.session_id != 0;
}

bool RingRun::is_child(const runtime::NodeReport& report) const {
  return std::any_of(children_.begin(), children_.end(), [&](const auto& m) {
    return m->name() == report.node && m->pid() == report.pid;
  });
}

bool RingRun::is_running(const std::string& name) {
  RunningNode* child = find(name);
  return child && !child->ended();
}

std::vector<std::string> RingRun::names() const {
  std::vector<std::string> all;
  for (const auto& child : children_)
    all.push_back(child->name());
  return all;
}

RunningNode* RingRun::find(const std::string& name) {
  for (const auto& child : children_)
    if (child->name() == name)
      return child.get();
  return nullptr;
}

}  // namespace voxtouch::cli
