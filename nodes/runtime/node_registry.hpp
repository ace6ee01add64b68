#pragma once
/// The nodes of this rig. Each node publishes its own status and reads the statuses of all others.
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/runtime/figure.hpp"
#include "nodes/runtime/heartbeat.hpp"
#include "nodes/runtime/rig_roles.hpp"

namespace voxtouch::runtime {

enum class NodeState : std::uint32_t {
  kStarting = msg::node_status::kStateStarting,
  kReady = msg::node_status::kStateReady,
  kRunning = msg::node_status::kStateRunning,
  kStopped = msg::node_status::kStateStopped,
  kFailed = msg::node_status::kStateFailed,
};

/// Name of the figure with the number of device sessions that the node has observed.
inline constexpr char kSessions[] = "sessions";

/// Names of two figures and one value of a report: how long a watched part has stalled, and which
/// part it is.
inline constexpr char kStalledFor[] = "stalled_s", kLongestStall[] = "longest_stall_s",
                      kStalled[] = "stalled";

/// Name of the value that states why scene and device are incompatible.
inline constexpr char kRefusal[] = "refusal";

/// Status of one node.
struct NodeReport {
  std::string node;
  std::string host;
  std::uint32_t pid = 0;
  bus::Guid participant{};
  std::uint64_t session_id = 0;
  NodeState state = NodeState::kStarting;
  std::string message;
  std::map<std::string, std::string> values;  ///< texts
  Figures figures;                            ///< numbers
  /// Time of arrival, by the watch clock of the receiving registry.
  std::int64_t received_ns = 0;
  /// lockstep: participants that the node waits for; local, not published.
  std::set<bus::Guid> lockstep_peers{};
  /// Whether no further report is expected.
  bool final() const noexcept {
    return state == NodeState::kStopped || state == NodeState::kFailed;
  }
};

/// Converts a status without checking its lengths.
NodeReport to_report(const msg::NodeStatus& status);

/// Publishes this node's report, also as /diagnostics while that topic has a reader. Not for the
/// loop: allocates.
class StatusWriter {
 public:
  StatusWriter(const bus::Participant& participant, std::string node, const std::string& rig);
  /// Fills in node, host, pid and participant. `set_publishing`: publish /diagnostics too.
  void publish(const NodeReport& report, bool set_publishing = true);
  /// Waits until readers have received the last report. Used at shutdown.
  void flush() noexcept;
  /// Number of /diagnostics messages.
  std::uint64_t diagnostics_made() const noexcept { return diagnostics_made_; }

 private:
  void publish_diagnostics(const NodeReport& report,
                           std::vector<msg::diagnostic_msgs_KeyValue> values);
  bus::Writer<msg::NodeStatus> writer_;
  bus::Writer<msg::diagnostic_msgs_DiagnosticArray> diagnostics_;
  std::string full_name_;  // for example "haptic/device"
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

/// The newest report of each present participant.
/// A status is refused if its sender is not the participant that it names, as in a replayed bag, or
/// if it exceeds the size limits. A writer that sends such a status, or floods the topic, is
/// ignored from then on.
class NodeRegistry {
 public:
  /// `up`: only participants in its claim may take a role; all zero: any participant may.
  NodeRegistry(const bus::Participant& participant, const std::string& rig,
               const bus::Guid& up = {});
  /// Takes the statuses that have arrived. Removes nodes whose participant has left, unless `keep`
  /// returns true.
  void update(const std::function<bool(const NodeReport&)>& keep = {});
  /// All reports, sorted by node name.
  std::vector<NodeReport> reports() const;
  std::optional<NodeReport> find(std::string_view node) const;
  /// Time since the last status of the node, counted while this registry was polled [s].
  double silent_s(const NodeReport& report) const noexcept {
    return static_cast<double>(clock_.now_ns() - report.received_ns) * 1e-9;
  }
  /// Nodes of the ring that hang: no status for kHungNs, or a status that reports a stalled loop.
  /// DDS detects a stopped process after some seconds. A node that left without a final status
  /// stays listed until another takes its name, for 10 s at most. Requires frequent calls of
  /// `update`.
  std::vector<Hung> hung() const;
  const NodeReport* report_of(const bus::Guid& participant) const;
  /// Whether `participant` has a status writer.
  bool is_here(const bus::Guid& participant) const { return here_.contains(participant); }
  /// Whether `up` started the ring, so that its claim assigns the roles.
  bool is_claimed() const noexcept { return roles_ != nullptr; }
  bool may_play(const std::string& node, const bus::Guid& participant) const {
    return !roles_ || roles_->names(node, participant);
  }
  /// Participants of some of the refused statuses.
  const std::set<bus::Guid>& refused_participants() const noexcept { return refused_participants_; }
  /// Number of refused statuses.
  std::uint64_t refused() const noexcept { return refused_; }
  /// The node of the participant `guid`, as named in this rig or in `ros_discovery_info` ("ROS 2's
  /// /talker"). Otherwise "an unnamed participant (GUID)".
  std::string name_of(const bus::Guid& guid) const;
  /// The same; empty for a participant without a name.
  std::string known_name_of(const bus::Guid& guid) const;

  static constexpr std::size_t kMaxNodes = 64, kMaxValues = 256, kMaxTextBytes = 1024;

 private:
  void remember_vanished();
  WatchClock clock_;
  void update_participants();
  static bool fits(const msg::NodeStatus& status);
  bool is_its_own(const msg::NodeStatus& status, dds_instance_handle_t writer) const;
  void take(const msg::NodeStatus& status);
  void refuse_floods();

  std::unique_ptr<bus::Following> senders_;  // outlives the reader, which calls it
  bus::Reader<msg::NodeStatus> reader_;
  std::shared_ptr<bus::Graph> graph_;
  /// Statuses of each writer, in this poll and in the last.
  std::map<dds_instance_handle_t, int> taken_, taken_before_;
  std::map<dds_instance_handle_t, bus::Guid> writers_;  ///< participant of each status writer
  std::set<bus::Guid> here_;
  std::uint64_t refused_ = 0;
  std::set<bus::Guid> refused_participants_;
  std::unique_ptr<RigRoles> roles_;
  std::map<bus::Guid, NodeReport> reports_;
  std::map<std::string, NodeReport> vanished_;  ///< departed without a final status, by name
};

/// Polls for `patience`. Returns the first report that satisfies `requested`, if one arrives.
std::optional<NodeReport> look_for(NodeRegistry& registry,
                                   const std::function<bool(const NodeReport&)>& requested,
                                   std::chrono::milliseconds patience);

/// Largest number of device sessions that any node of the registry reports.
std::uint64_t sessions_seen(const NodeRegistry& registry);

/// Whether for each of `nodes` a participant of that name is in `matched`.
bool has_matched(const NodeRegistry& registry, const std::vector<bus::Guid>& matched,
                 const std::vector<std::string>& nodes);

}  // namespace voxtouch::runtime
