#pragma once
/// Who runs in this rig: each node publishes its own status and reads everybody's.
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

/// Name of a report's figure: how many device sessions the node has seen.
inline constexpr char kSessions[] = "sessions";

/// Figures and word of a report: for how long what is watched in addition to the monitor has
/// stalled, and what it is.
inline constexpr char kStalledFor[] = "stalled_s", kLongestStall[] = "longest_stall_s",
                      kStalled[] = "stalled";

/// Word of a report that has failed: why scene and device do not go together.
inline constexpr char kRefusal[] = "refusal";

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
  std::int64_t received_ns = 0;    ///< when it came, by the watch of the registry that took it
  std::set<bus::Guid> partners{};  ///< lockstep: whom the node waits for; known to the node alone,
                                   ///< and not published
  /// Nothing more is to come from it.
  bool final() const noexcept {
    return state == NodeState::kStopped || state == NodeState::kFailed;
  }
};

/// A status as its node meant it; its lengths are not checked yet.
NodeReport to_report(const msg::NodeStatus& status);

/// Publishes this node's report, and the same as /diagnostics while that has a reader. Not for
/// the loop: allocates.
class StatusWriter {
 public:
  StatusWriter(const bus::Participant& participant, std::string node, const std::string& rig);
  /// Node, host, pid and participant are filled in here. `set_publishing`: as /diagnostics too.
  void publish(const NodeReport& report, bool set_publishing = true);
  /// Waits until readers have the last report; for the way out.
  void flush() noexcept;
  /// How often /diagnostics was made.
  std::uint64_t diagnostics_made() const noexcept { return diagnostics_made_; }

 private:
  void publish_diagnostics(const NodeReport& report,
                           std::vector<msg::diagnostic_msgs_KeyValue> values);
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

/// The newest report of each participant that is still there. Only its own: a status that comes
/// from another participant than it names, as a bag that is played sends, is refused, and so is one
/// that is longer than any of ours. A writer of such a one, or of a flood, is not listened to any
/// more.
class NodeRegistry {
 public:
  /// `up`: only whom its claim names may play a role; all zero: any participant.
  NodeRegistry(const bus::Participant& participant, const std::string& rig,
               const bus::Guid& up = {});
  /// Takes what has arrived; forgets nodes whose participant has gone, but for those that `keep`
  /// holds on to.
  void update(const std::function<bool(const NodeReport&)>& keep = {});
  /// All reports, sorted by node name.
  std::vector<NodeReport> reports() const;
  std::optional<NodeReport> find(std::string_view node) const;
  /// For how long no status of a node has come, while this registry was looked at [s].
  double silent_s(const NodeReport& report) const noexcept {
    return static_cast<double>(clock_.now_ns() - report.received_ns) * 1e-9;
  }
  /// Nodes of the ring that hang: no status for kHungNs, or one that says that its loop stands
  /// still. A node whose participant has gone without a last word, as DDS finds of a stopped one
  /// after some seconds, is among them until another takes its name, for 10 s at most. Call
  /// `update` often.
  std::vector<Hung> hung() const;
  const NodeReport* report_of(const bus::Guid& participant) const;
  /// Whether a status writer of `participant` is there.
  bool is_here(const bus::Guid& participant) const { return here_.contains(participant); }
  /// Whether `up` started the ring, so that its claim names who plays a role.
  bool is_claimed() const noexcept { return roles_ != nullptr; }
  bool may_play(const std::string& node, const bus::Guid& participant) const {
    return !roles_ || roles_->names(node, participant);
  }
  /// Participants of some of the statuses that were refused.
  const std::set<bus::Guid>& refused_participants() const noexcept { return refused_participants_; }
  /// Statuses that were refused.
  std::uint64_t refused() const noexcept { return refused_; }
  /// The node whose participant is `guid`: of this rig, or as `ros_discovery_info` names it ("ROS
  /// 2's /talker"); else "a participant that gives no name (GUID)".
  std::string name_of(const bus::Guid& guid) const;
  /// The same; empty if it gives no name.
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

  std::unique_ptr<bus::Following> senders_;  // outlives the reader, which asks it
  bus::Reader<msg::NodeStatus> reader_;
  std::shared_ptr<bus::Graph> graph_;
  std::map<dds_instance_handle_t, int> taken_,
      taken_before_;  ///< statuses of each writer, in this look and in the last
  std::map<dds_instance_handle_t, bus::Guid> writers_;  ///< of the statuses: whose each is
  std::set<bus::Guid> here_;
  std::uint64_t refused_ = 0;
  std::set<bus::Guid> refused_participants_;
  std::unique_ptr<RigRoles> roles_;
  std::map<bus::Guid, NodeReport> reports_;
  std::map<std::string, NodeReport> vanished_;  ///< gone without a last word, by name
};

/// Looks for `patience`: the first report that `requested` holds of, if one comes.
std::optional<NodeReport> look_for(NodeRegistry& registry,
                                   const std::function<bool(const NodeReport&)>& requested,
                                   std::chrono::milliseconds patience);

/// How many device sessions the nodes of the registry have seen: the most that one of them reports.
std::uint64_t sessions_seen(const NodeRegistry& registry);

/// Whether for each of `nodes` a participant of that name is in `matched`.
bool has_matched(const NodeRegistry& registry, const std::vector<bus::Guid>& matched,
                 const std::vector<std::string>& nodes);

}  // namespace voxtouch::runtime
