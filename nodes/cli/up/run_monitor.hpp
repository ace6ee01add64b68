#pragma once
/// Receives the statuses of the nodes during a run and prints changes at once.
#include <map>
#include <optional>
#include <set>
#include <string>

#include "nodes/bus/ros_discovery.hpp"
#include "nodes/cli/up/foreign_writers.hpp"
#include "nodes/cli/up/rig_claim.hpp"
#include "nodes/cli/up/run_record.hpp"
#include "nodes/cli/up/start_report.hpp"

namespace voxtouch::cli {

class ProcessSupervisor;
class RunningNode;

class RunMonitor {
 public:
  /// `graph`: how the ring's nodes show themselves to ROS 2. `participant` must outlive it.
  RunMonitor(const bus::Participant& participant, const std::string& rig, bus::RosGraph graph,
             StartReport start);

  /// A process next to the nodes that plays the role `page`; the run does not depend on it.
  void set_page(const RunningNode& page) { page_ = &page; }
  /// Takes received messages. Call it at least every 20 ms: longer pauses are reported as silence
  /// of "up".
  void poll(const ProcessSupervisor& nodes);
  const Reports& reports() const noexcept { return reports_; }
  /// Whether this node's last status has state READY.
  bool is_ready(const std::string& node) const;
  /// Participants of the nodes, of each process that was started.
  const Players& players() const noexcept { return players_; }
  /// Prints start messages that are due, and nodes that hang or respond again. Returns the node
  /// that has been silent for too long.
  std::optional<std::string> watch(const ProcessSupervisor& nodes);
  /// Once a second: the status line, and obstacles of nodes.
  void print(const ProcessSupervisor& nodes);

  bool hangs(const std::string& node) const { return hanging_.contains(node); }
  double silent_s(const std::string& node) const;
  /// The node's process has ended and is to be started again: its figures are kept, its silence is
  /// no fault of the next one.
  void forget(const std::string& node);
  bool last_process_is_here(const std::string& node) const;
  /// Another process that has this role now; empty: none.
  std::string taken_by(const std::string& node) const;
  /// Reports, silences and unauthorised.
  void report_to(RunRecord& run) const;

 private:
  void log_once(const std::string& node, const std::string& text);
  runtime::NodeRegistry registry_;
  const bus::Guid own_;
  const RunningNode* page_ = nullptr;
  bus::Reader<msg::ValidationReport>
      verdicts_;  ///< the validator works only while it has a reader; its counts are in its status
  ForeignWriters writers_;
  bus::RosDiscovery ros_;
  const bus::RosGraph graph_;
  StartReport start_;
  Reports reports_, earlier_;  ///< earlier: of processes that have ended
  Players players_;
  std::map<std::string, bus::Guid> plays_;  ///< authorised status writer of each node: the first
                                            ///< participant with its process number
  std::map<std::string, double> silence_s_;
  std::set<std::string> hanging_;               ///< nodes that give no sign of life now
  std::map<std::string, std::string> printed_;  ///< last printed text, by node
  std::int64_t last_poll_ns_ = 0;
};

}  // namespace voxtouch::cli
