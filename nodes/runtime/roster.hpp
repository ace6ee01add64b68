#pragma once
/// Who runs in this rig: each node publishes its own status and reads everybody's.
#include <chrono>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/runtime/figure.hpp"
#include "nodes/runtime/heartbeat.hpp"

namespace voxtouch::runtime {

enum class NodeState : std::uint32_t {
  kStarting = msg::node_status::kStateStarting,
  kReady = msg::node_status::kStateReady,
  kRunning = msg::node_status::kStateRunning,
  kStopped = msg::node_status::kStateStopped,
  kFailed = msg::node_status::kStateFailed,
};

/// Name of a report's figure: how many device sessions the node has seen.
inline constexpr char kSessions[] = "sessions";

/// Figures and word of a report: for how long what is watched beside the housekeeping has not turned, and what it is.
inline constexpr char kStalledFor[] = "stalled_s", kLongestStall[] = "longest_stall_s", kStalled[] = "stalled";

/// One node's status as a value.
struct NodeReport {
  std::string node;
  std::string host;
  std::uint32_t pid = 0;
  bus::Guid participant{};
  std::uint64_t session_id = 0;
  NodeState state = NodeState::kStarting;
  std::string message;
  std::map<std::string, std::string> values;  ///< words
  Figures figures;                            ///< numbers
  std::int64_t heard_ns = 0;                  ///< when it came, by the watch of the roster that took it
  /// Nothing more is to come from it.
  bool final() const noexcept { return state == NodeState::kStopped || state == NodeState::kFailed; }
};

/// Publishes this node's report, and the same as /diagnostics while somebody reads that. Not for the loop: allocates.
class StatusWriter {
 public:
  StatusWriter(const bus::Participant& participant, std::string node, const std::string& rig);
  /// Node, host, pid and participant are filled in here. `tell_ros`: as /diagnostics too.
  void publish(const NodeReport& report, bool tell_ros = true);
  /// Waits until readers have the last report; for the way out.
  void flush() noexcept;
  /// How often /diagnostics was made.
  std::uint64_t diagnostics_made() const noexcept { return diagnostics_made_; }

 private:
  void publish_diagnostics(const NodeReport& report, std::vector<msg::diagnostic_msgs_KeyValue> values);
  bus::Writer<msg::NodeStatus> writer_;
  bus::Writer<msg::diagnostic_msgs_DiagnosticArray> diagnostics_;
  std::string full_name_;  // "haptic/device"
  std::uint64_t diagnostics_made_ = 0;
  NodeReport own_;
};

/// A node that gives no sign of life.
struct Hung {
  std::string node;
  bus::Guid participant{};
  double for_s = 0.0;
  std::string sentence;
};

/// The newest report of each participant that is still there.
class Roster {
 public:
  Roster(const bus::Participant& participant, const std::string& rig);
  /// Takes what has arrived; forgets nodes whose participant has gone unless `keep_gone`.
  void update(bool keep_gone = false);
  /// All reports, sorted by node name.
  std::vector<NodeReport> reports() const;
  std::optional<NodeReport> find(std::string_view node) const;
  /// For how long no status of a node has come, while this roster was looked at [s].
  double silent_s(const NodeReport& report) const noexcept {
    return static_cast<double>(clock_.now_ns() - report.heard_ns) * 1e-9;
  }
  /// Nodes of the ring that hang: no status for kHungNs, or one that says that its loop stands still. A node whose participant has
  /// gone without a last word, as DDS finds of a stopped one after some seconds, is among them until another takes its name, for 10 s
  /// at most. Call `update` often.
  std::vector<Hung> hung() const;
  /// Name of the node whose participant is `guid`, or "an unknown participant".
  std::string name_of(const bus::Guid& guid) const;
  dds_entity_t condition() const noexcept { return reader_.condition(); }

 private:
  void remember_vanished(const std::vector<bus::Guid>& here);
  WatchClock clock_;
  bus::Reader<msg::NodeStatus> reader_;
  std::map<bus::Guid, NodeReport> reports_;
  std::map<std::string, NodeReport> vanished_;  ///< gone without a last word, by name
};

/// Looks for `patience`: the first report of `node` (of any node where that is empty), if one comes.
std::optional<NodeReport> look_for_others(Roster& roster, std::string_view node, std::chrono::milliseconds patience);

/// How many device sessions the nodes of the roster have seen: the most that one of them reports.
std::uint64_t sessions_seen(const Roster& roster);

/// Whether `matched` holds the participant of every node of `nodes` that the roster knows; false where one is not known yet.
bool has_matched(const Roster& roster, const std::vector<bus::Guid>& matched, const std::vector<std::string>& nodes);

}  // namespace voxtouch::runtime
