#pragma once
/// The nodes of one ring: starts, stops and, if requested, restarts them.
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "nodes/cli/up/launcher.hpp"
#include "nodes/cli/up/run_record.hpp"

namespace voxtouch::cli {

class RunMonitor;

class ProcessSupervisor {
 public:
  /// `restarts`: nodes that may be started again in the run; the device never is.
  ProcessSupervisor(LauncherOptions options, const scene::Scene& scene, std::uint64_t restarts);
  /// Stops the device first, also after an exception.
  ~ProcessSupervisor();
  ProcessSupervisor(const ProcessSupervisor&) = delete;
  ProcessSupervisor& operator=(const ProcessSupervisor&) = delete;

  /// All but the device. Throws std::runtime_error, a sentence, if a program cannot be started.
  void start();
  void start_device();
  bool device_is_started() const noexcept { return device_is_started_; }
  /// Handles nodes that have ended. Returns false if the run ends; the reason is then in `events`.
  bool poll(const RunMonitor& monitor);
  /// Nodes that are to be started again. Call RunMonitor::forget for each.
  std::vector<std::string> take_restarting();
  /// Starts each of these once DDS has taken out its last process: until then others are bound to
  /// it. False if the run ends for it.
  bool restart(const RunMonitor& monitor);
  /// Stops the device first, the logger last. `poll` is called meanwhile.
  void stop(RunMonitor& monitor, bool is_timed);

  std::vector<std::string> names() const;
  RunningNode* find(const std::string& name) const;
  bool is_running(const std::string& name) const;
  /// Restarts, events and started nodes.
  void report_to(RunRecord& run) const;

 private:
  std::string check_restart(const std::string& name, const RunMonitor& monitor) const;
  int wait_for_end(RunningNode& node, RunMonitor& monitor) const;
  void note_end(const std::string& name, int status, const Reports& reports);

  LauncherOptions options_;
  const std::filesystem::path scene_, bag_;
  const std::string scene_hash_;
  const std::uint64_t most_restarts_;
  std::vector<std::unique_ptr<RunningNode>> nodes_;
  std::set<std::string> started_, noted_;  ///< noted: nodes with their end in `events`
  std::vector<Restart> restarts_;
  std::vector<std::string> restarting_;
  std::vector<Found> events_;
  bool device_is_started_ = false;
};

}  // namespace voxtouch::cli
