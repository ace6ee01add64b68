#pragma once
/// One run of `voxtouch up`: claim the rig, start the nodes, watch them, stop them in order,
/// evaluate the run.
#include <filesystem>
#include <string>

#include "nodes/cli/up/process_supervisor.hpp"
#include "nodes/cli/up/rig_claim.hpp"
#include "nodes/cli/up/run_files.hpp"
#include "nodes/cli/up/run_monitor.hpp"
#include "nodes/cli/up/summary.hpp"

namespace voxtouch::cli {

struct UpOptions {
  runtime::NodeOptions node;  ///< common options of all nodes
  LauncherOptions ring;       ///< additional options of each node
  ChosenLimits limits;
  std::uint64_t restarts = 0;  ///< nodes that may be started again in the run; the device never is
  bool no_record = false, no_report = false, json = false, view = false, browser = false;
};

class RingRun {
 public:
  /// Joins the domain and announces the ring. `options` must outlive it.
  RingRun(const UpOptions& options, const scene::Scene& scene, StartReport start);
  /// The process of the ring's page, which has the role `page` from its first status on. The run
  /// reports its end. It outlives the run.
  void set_page(RunningNode& page) {
    page_ = &page;
    monitor_.set_page(page);
  }
  /// Returns once every node has ended. Throws std::runtime_error, a sentence, if the rig is in
  /// use, a node cannot be started, or rendering or coupling refuses scene and device before any
  /// force: then no bag is left.
  RunSummary go();

 private:
  LauncherOptions launcher_options(const scene::Scene& scene) const;
  /// Returns when the device has finished, a node has died, or Ctrl-C was received.
  void watch();
  void poll();
  /// Starts the device when the nodes that it needs are ready. It starts last, so that its first
  /// sample is answered and recorded.
  void start_device();
  /// Why no sample was answered, in the words of rendering or coupling; empty: none of them
  /// refused.
  std::string refused_at_start() const;
  /// For a run that was refused, so that the same command can be repeated.
  void remove_bag() const;

  const UpOptions& options_;
  EmptyFolderGuard default_bag_;  ///< empty for a named bag
  RunSummary summary_;
  RigClaim claim_;
  RunMonitor monitor_;
  RunningNode* page_ = nullptr;   ///< null: there is none, or its end was reported
  bool page_has_chosen_ = false;  ///< the next run is chosen: this run ends
  std::filesystem::path faults_;
  ProcessSupervisor nodes_;
  std::string refusal_;  ///< of rendering or coupling, before any sample was answered
};

}  // namespace voxtouch::cli
