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
};

/// Publishes this node's report, and the same as /diagnostics while somebody reads that. Not for the loop: allocates.
class StatusWriter {
 public:
  StatusWriter(const bus::Participant& participant, std::string node, const std::string& rig);
  void publish(const NodeReport& report);  ///< node, host, pid and participant are filled in here
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

/// The newest report of each participant that is still there.
class Roster {
 public:
  Roster(const bus::Participant& participant, const std::string& rig);
  /// Takes what has arrived; forgets nodes whose participant has gone unless `keep_gone`.
  void update(bool keep_gone = false);
  /// All reports, sorted by node name.
  std::vector<NodeReport> reports() const;
  std::optional<NodeReport> find(std::string_view node) const;
  /// Name of the node whose participant is `guid`, or "an unknown participant".
  std::string name_of(const bus::Guid& guid) const;
  dds_entity_t condition() const noexcept { return reader_.condition(); }

 private:
  bus::Reader<msg::NodeStatus> reader_;
  std::map<bus::Guid, NodeReport> reports_;
};

/// Looks for `patience`: the first report of `node` (of any node where that is empty), if one comes.
std::optional<NodeReport> look_for_others(Roster& roster, std::string_view node, std::chrono::milliseconds patience);

/// How many device sessions the nodes of the roster have seen: the most that one of them reports.
std::uint64_t sessions_seen(const Roster& roster);

/// Whether `matched` holds the participant of every node of `nodes` that the roster knows; false where one is not known yet.
bool has_matched(const Roster& roster, const std::vector<bus::Guid>& matched, const std::vector<std::string>& nodes);

}  // namespace voxtouch::runtime
