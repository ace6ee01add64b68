#pragma once
/// The slow half of a node: a thread of ordinary priority that reports ten times a second, so that
/// the loop never has to, tells who hangs: another node, or its own loop, and tells ROS tools state
/// and sentences of the node.
#include <atomic>
#include <functional>
#include <set>
#include <thread>

#include "nodes/log/tell.hpp"
#include "nodes/runtime/life_cycle.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/options.hpp"
#include "nodes/runtime/ros_log.hpp"

namespace voxtouch::runtime {

/// What must not stand still beside the housekeeping.
struct Watched {
  std::string what;                     ///< "its loop"
  std::function<std::uint64_t()> sign;  ///< another number at each look while all is well
  StallWatch watch{};
};

class Housekeeping {
 public:
  /// `look` is called about every 20 ms, in the first second every 5: it fills the report (state,
  /// session, message, values) from the loop's atomics. The report is published when state, session
  /// or message change, and ten times a second.
  Housekeeping(const bus::Participant& participant, std::string node, const NodeOptions& options,
               std::function<void(NodeRegistry&, NodeReport&)> look,
               std::vector<Watched> watched = {});
  /// Publishes a last report (`look` is asked once more) and waits until readers have it.
  ~Housekeeping();
  Housekeeping(const Housekeeping&) = delete;
  Housekeeping& operator=(const Housekeeping&) = delete;

  /// Lockstep: a node that takes part has given no sign of life for kGivenUpNs. There is nothing
  /// more to wait for.
  bool peer_lost() const noexcept { return peer_lost_.load(std::memory_order_relaxed); }

 private:
  void cycle();
  void compare_scenes(NodeReport& report) const;
  void watch_own(NodeReport& report);
  void watch_others(NodeReport& report);
  void cycle_or_skip() noexcept;
  void tell_ros(const NodeReport& report);

  const NodeOptions& options_;
  std::string node_;
  StatusWriter writer_;
  NodeRegistry registry_;
  LifeCycle life_cycle_;
  RosLog ros_log_;
  std::function<void(NodeRegistry&, NodeReport&)> look_;
  WatchClock clock_;
  std::vector<Watched> watched_;
  double longest_stall_s_ = 0.0;
  std::atomic<bool> peer_lost_{false};
  bus::Guid own_;
  NodeReport last_;
  std::int64_t last_publish_ns_ = 0, last_ros_ns_ = 0, last_line_ns_ = 0;
  const bool rate_lines_ =
      options_.announce &&
      !log::stderr_is_journal();  ///< once a second, of a node that was started by hand
  Figures at_last_line_;
  bool had_session_ = false;
  std::set<bus::Guid> partners_;  ///< whom this node waits for, as `look` said last
  std::string lost_;              ///< the sentence for a peer that was lost
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace voxtouch::runtime
