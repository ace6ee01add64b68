#pragma once
/// The slow half of a node: a thread of ordinary priority that reports once a second, so that the loop never has to.
#include <atomic>
#include <functional>
#include <mutex>
#include <thread>

#include "nodes/runtime/options.hpp"
#include "nodes/runtime/roster.hpp"

namespace voxtouch::runtime {

class Housekeeping {
 public:
  /// `look` is called about every 20 ms: it fills the report (state, session, message, values) from the loop's atomics. The report
  /// is published when state, session or message change, and once a second.
  Housekeeping(const bus::Participant& participant, std::string node, const NodeOptions& options,
               std::function<void(Roster&, NodeReport&)> look);
  /// Publishes a last report (`look` is asked once more) and waits until readers have it.
  ~Housekeeping();
  Housekeeping(const Housekeeping&) = delete;
  Housekeeping& operator=(const Housekeeping&) = delete;

 private:
  void turn();
  void compare_scenes(NodeReport& report) const;
  void turn_or_skip() noexcept;

  const NodeOptions& options_;
  std::string node_;
  StatusWriter writer_;
  Roster roster_;
  std::function<void(Roster&, NodeReport&)> look_;
  NodeReport last_;
  std::int64_t last_publish_ns_ = 0;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace voxtouch::runtime
