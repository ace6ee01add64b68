#pragma once
/// The nodes that a device waits for before its first sample, and that in lockstep must not be
/// lost.
#include <atomic>
#include <string>

#include "nodes/runtime/node_host.hpp"

namespace voxtouch::device_node {

/// The monitor updates; `ready`: any thread.
class LockstepPeers {
 public:
  /// `with_coupling`: a coupling is bound.
  void update(const runtime::NodeHost& host, runtime::NodeRegistry& registry, std::uint64_t session,
              bool with_coupling);
  bool ready() const noexcept { return ready_.load(std::memory_order_acquire); }
  /// What is not ready yet; empty: nothing.
  const std::string& missing() const noexcept { return missing_; }
  /// The session cannot go on; the first reason counts.
  void lose(std::string why) {
    if (lost_.empty())
      lost_ = std::move(why);
  }
  /// Which peer was lost first, and how.
  const std::string& lost() const noexcept { return lost_; }
  const std::set<bus::Guid>& participants() const noexcept { return partners_.participants(); }

 private:
  runtime::PeerSet partners_{{"rendering", "coupling", "logger", "validator"}};
  std::atomic<bool> ready_{false};
  std::string missing_, lost_;
};

}  // namespace voxtouch::device_node
