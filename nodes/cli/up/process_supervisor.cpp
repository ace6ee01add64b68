#include "nodes/cli/up/process_supervisor.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "core/scene/scene_file.hpp"
#include "nodes/cli/up/run_monitor.hpp"
#include "nodes/cli/up/start_report.hpp"
#include "nodes/console/log.hpp"

namespace voxtouch::cli {
namespace {

constexpr unsigned kPollPeriodUs = 20'000;

}  // namespace

ProcessSupervisor::ProcessSupervisor(LauncherOptions options, const scene::Scene& scene,
                                     std::uint64_t restarts)
    : options_(std::move(options)),
      scene_(options_.rendering.scene),
      bag_(options_.logger.bag),
      scene_hash_(scene.hash),
      most_restarts_(restarts) {}

ProcessSupervisor::~ProcessSupervisor() {
  while (!nodes_.empty())
    nodes_.pop_back();
}

void ProcessSupervisor::start() {
  nodes_ = launch(options_);
  for (const auto& node : nodes_)
    started_.insert(node->name());
}

void ProcessSupervisor::start_device() {
  nodes_.push_back(start_node(options_, "device"));
  started_.insert("device");
  device_is_started_ = true;
}

bool ProcessSupervisor::poll(const RunMonitor& monitor) {
  bool goes_on = true;
  std::erase_if(nodes_, [&](const auto& node) {
    const auto status = node->ended();
    const std::string& name = node->name();
    if (!status)
      return false;
    // The rendering's reason comes first, for example an unreadable mesh.
    if (!device_is_started_ && name != "rendering" && is_running("rendering") &&
        !StartReport::scene_is_built(monitor.reports()))
      return false;
    if (name != "device" && restarts_.size() < most_restarts_) {
      restarts_.push_back(
          {name, how_ended(*status), number(monitor.reports(), "device", "samples")});
      console::log("  {} ended by {}: force is zero, restarting it ({} of {})\n", name,
                   how_ended(*status), restarts_.size(), most_restarts_);
      restarting_.push_back(name);
      return true;
    }
    if (name != "device" || *status != 0)
      note_end(name, *status, monitor.reports());
    goes_on = false;
    return false;
  });
  // A node that has failed but continues to report ends the run: without it there is no force.
  for (const auto& [name, report] : monitor.reports())
    if (report.state == runtime::NodeState::kFailed && name != "device" &&
        noted_.insert(name).second) {
      events_.push_back({RunFact::kNodeFailed, name, 0.0, 0.0, report.message});
      goes_on = false;
    }
  return goes_on;
}

std::vector<std::string> ProcessSupervisor::take_restarting() {
  return std::exchange(restarting_, {});
}

bool ProcessSupervisor::restart(const RunMonitor& monitor) {
  for (Restart& restart : restarts_) {
    if (restart.is_done || monitor.last_process_is_here(restart.node))
      continue;
    try {
      if (const std::string why = check_restart(restart.node, monitor); !why.empty())
        throw std::runtime_error(why);
      // A started bag is left unchanged.
      if (restart.node == "logger")
        options_.logger.bag += "_again";
      nodes_.insert(nodes_.begin(), start_node(options_, restart.node));  // the device stays last
    } catch (const std::exception& error) {
      events_.push_back({RunFact::kNotRestarted, restart.node, 0.0, 0.0, error.what()});
      return false;
    }
    restart.is_done = true;
  }
  return true;
}

std::string ProcessSupervisor::check_restart(const std::string& name,
                                             const RunMonitor& monitor) const {
  if (std::string taken = monitor.taken_by(name); !taken.empty())
    return taken + " has taken its role";
  if (scene::load_scene(scene_).hash != scene_hash_)
    return fmt::format("{} has changed since the start", scene_.string());
  return {};
}

void ProcessSupervisor::stop(RunMonitor& monitor, bool is_timed) {
  for (const char* name : {"device", "rendering", "coupling", "validator", "logger"}) {
    RunningNode* const node = find(name);
    if (!node)
      continue;
    node->request_stop();
    const int status = wait_for_end(*node, monitor);
    monitor.poll(*this);
    // A device that is stopped before its duration is over ends with status 1; the reason is known
    // here already.
    const auto report = monitor.reports().find(name);
    const bool failed =
        report != monitor.reports().end() && report->second.state == runtime::NodeState::kFailed;
    const bool cut_short = node->name() == "device" && status == 1 && is_timed && !failed;
    if (status != 0 && !cut_short)
      note_end(name, status, monitor.reports());
  }
}

/// A node that hung earlier is ended after a second. The logger writes the end of the bag and gets
/// the time of a watched node, for a slow disk.
int ProcessSupervisor::wait_for_end(RunningNode& node, RunMonitor& monitor) const {
  using Clock = std::chrono::steady_clock;
  const bool logger = node.name() == "logger", hung = monitor.hangs(node.name());
  const auto since = [begun = Clock::now()] {
    return std::chrono::duration<double>(Clock::now() - begun).count();
  };
  bool reported = false;
  while (!node.ended() && since() < (logger ? 20.0 : 8.0)) {
    monitor.poll(*this);
    if (hung && (logger ? monitor.silent_s("logger") > 1e-9 * runtime::kGivenUpNs : since() > 1.0))
      break;
    if (logger && !reported && since() > 1.0) {
      console::log("  the logger is writing its queue to the bag\n");
      reported = true;
    }
    ::usleep(kPollPeriodUs);
  }
  return node.join(std::chrono::milliseconds(0));
}

void ProcessSupervisor::note_end(const std::string& name, int status, const Reports& reports) {
  if (!noted_.insert(name).second)
    return;
  const auto report = reports.find(name);
  if (report != reports.end() && report->second.state == runtime::NodeState::kFailed)
    events_.push_back({RunFact::kNodeFailed, name, 0.0, 0.0, report->second.message});
  else
    events_.push_back({RunFact::kNodeEnded, name, static_cast<double>(status)});
}

std::vector<std::string> ProcessSupervisor::names() const {
  std::vector<std::string> all;
  for (const auto& node : nodes_)
    all.push_back(node->name());
  return all;
}

RunningNode* ProcessSupervisor::find(const std::string& name) const {
  const auto found =
      std::ranges::find_if(nodes_, [&](const auto& node) { return node->name() == name; });
  return found == nodes_.end() ? nullptr : found->get();
}

bool ProcessSupervisor::is_running(const std::string& name) const {
  RunningNode* const node = find(name);
  return node && !node->ended();
}

void ProcessSupervisor::report_to(RunRecord& run) const {
  run.restarts = restarts_, run.started = started_;
  run.events.insert(run.events.end(), events_.begin(), events_.end());
  if (options_.logger.bag != bag_)
    run.events.push_back({RunFact::kBagGoesOn, "", 0.0, 0.0, options_.logger.bag.string()});
}

}  // namespace voxtouch::cli
