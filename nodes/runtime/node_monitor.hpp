#pragma once
/// The monitor of a node: a thread of ordinary priority next to the loop. It publishes the status
/// ten times a second, reports nodes and loops that hang, and publishes state and messages for ROS
/// tools.
#include <atomic>
#include <functional>
#include <optional>
#include <set>
#include <thread>

#include "nodes/console/log.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/options.hpp"
#include "nodes/runtime/parameter_services.hpp"
#include "nodes/runtime/ros_log.hpp"
#include "nodes/runtime/status_line.hpp"

namespace voxtouch::runtime {

/// A sign of life that must not stall while the monitor runs.
struct Watched {
  std::string what;  ///< for example "its loop"
  /// Returns a different number at each poll while the watched part runs.
  std::function<std::uint64_t()> sign;
  StallWatch watch{};
};

/// Finds stalled parts of this node.
class OwnStalls {
 public:
  explicit OwnStalls(std::vector<Watched> watched) : watched_(std::move(watched)) {}
  /// A part that has ended is not reported as stalled.
  void poll(NodeReport& report);
  /// Time spent watching [ns].
  std::int64_t watched_ns() const noexcept { return clock_.now_ns(); }

 private:
  WatchClock clock_;
  std::vector<Watched> watched_;
  double longest_s_ = 0.0;
};

class NodeMonitor {
 public:
  /// `poll` is called about every 20 ms, and every 5 ms in the first second. It fills the report
  /// (state, session, message, values) from the loop's atomics. The report is published ten times a
  /// second, and when state, session or message change.
  NodeMonitor(const bus::Participant& participant, std::string node, const NodeOptions& options,
              std::function<void(NodeRegistry&, NodeReport&)> poll,
              std::vector<Watched> watched = {});
  /// Calls `poll` again, publishes a last report and waits until readers have received it.
  ~NodeMonitor();
  NodeMonitor(const NodeMonitor&) = delete;
  NodeMonitor& operator=(const NodeMonitor&) = delete;

  /// Lockstep: whether a participating node has given no sign of life for kGivenUpNs. The run then
  /// ends.
  bool peer_lost() const noexcept { return peer_lost_.load(std::memory_order_relaxed); }

 private:
  void cycle();
  void compare_scenes(NodeReport& report) const;
  /// Reports once if no message of another node has arrived for 3 s after the start, or if an
  /// address of DDS has disappeared.
  void watch_reception(NodeReport& report);
  void watch_others(NodeReport& report);
  void cycle_or_skip() noexcept;
  void set_publishing(const NodeReport& report);

  const NodeOptions& options_;
  std::string node_;
  StatusWriter writer_;
  NodeRegistry registry_;
  RequestLimit requests_{100};
  /// Absent in a rendering, which serves its own parameters.
  std::optional<ParameterServices> parameters_;
  RosLog ros_log_;
  std::function<void(NodeRegistry&, NodeReport&)> poll_;
  OwnStalls stalls_;
  std::atomic<bool> peer_lost_{false};
  bus::Guid own_;
  NodeReport last_;
  std::int64_t last_publish_ns_ = 0, last_ros_ns_ = 0;
  RateLine rate_line_;
  bool had_session_ = false;
  /// Participants that this node waits for, as last set by `poll`.
  std::set<bus::Guid> lockstep_peers_;
  bool has_received_ = false;
  std::string reception_fault_;  ///< message about missing reception; empty if no fault is known
  std::int64_t reception_checked_ns_ = 0;
  std::string lost_;  ///< message about a lost peer
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace voxtouch::runtime
