#pragma once
/// The slow half of a node: a thread of ordinary priority that reports ten times a second, so that
/// the loop never has to, reports what hangs: another node, or its own loop, and reports to ROS
/// tools state and sentences of the node.
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

/// What must not stall while the monitor runs.
struct Watched {
  std::string what;                     ///< "its loop"
  std::function<std::uint64_t()> sign;  ///< another number at each look while all is well
  StallWatch watch{};
};

/// Finds what stands still in this node.
class OwnStalls {
 public:
  explicit OwnStalls(std::vector<Watched> watched) : watched_(std::move(watched)) {}
  /// What has ended stands still by right.
  void look(NodeReport& report);
  /// Time spent watching [ns].
  std::int64_t watched_ns() const noexcept { return clock_.now_ns(); }

 private:
  WatchClock clock_;
  std::vector<Watched> watched_;
  double longest_s_ = 0.0;
};

class NodeMonitor {
 public:
  /// `look` is called about every 20 ms, in the first second every 5: it fills the report (state,
  /// session, message, values) from the loop's atomics. The report is published when state, session
  /// or message change, and ten times a second.
  NodeMonitor(const bus::Participant& participant, std::string node, const NodeOptions& options,
              std::function<void(NodeRegistry&, NodeReport&)> look,
              std::vector<Watched> watched = {});
  /// Publishes a last report (`look` is asked once more) and waits until readers have it.
  ~NodeMonitor();
  NodeMonitor(const NodeMonitor&) = delete;
  NodeMonitor& operator=(const NodeMonitor&) = delete;

  /// Lockstep: a node that takes part has given no sign of life for kGivenUpNs. There is nothing
  /// more to wait for.
  bool peer_lost() const noexcept { return peer_lost_.load(std::memory_order_relaxed); }

 private:
  void cycle();
  void compare_scenes(NodeReport& report) const;
  /// Nothing has come from any other node for 3 s after the start, or an address of DDS is gone:
  /// reported once.
  void watch_reception(NodeReport& report);
  void watch_others(NodeReport& report);
  void cycle_or_skip() noexcept;
  void set_publishing(const NodeReport& report);

  const NodeOptions& options_;
  std::string node_;
  StatusWriter writer_;
  NodeRegistry registry_;
  RequestLimit requests_{100};
  std::optional<ParameterServices> parameters_;  ///< none of a rendering, which serves its own
  RosLog ros_log_;
  std::function<void(NodeRegistry&, NodeReport&)> look_;
  OwnStalls stalls_;
  std::atomic<bool> peer_lost_{false};
  bus::Guid own_;
  NodeReport last_;
  std::int64_t last_publish_ns_ = 0, last_ros_ns_ = 0;
  RateLine rate_line_;
  bool had_session_ = false;
  std::set<bus::Guid> partners_;  ///< whom this node waits for, as `look` said last
  bool has_received_ = false;
  std::string deaf_;  ///< the sentence; empty: all is well, as far as is known
  std::int64_t reception_checked_ns_ = 0;
  std::string lost_;  ///< the sentence for a peer that was lost
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace voxtouch::runtime
