#pragma once
/// The nodes that a device waits for at its start, and that must not be lost in lockstep.
#include <atomic>
#include <string>

#include "nodes/runtime/node_host.hpp"

namespace voxtouch::device_node {

/// Updated by the monitor; `ready` may be called by any thread.
class LockstepPeers {
 public:
  /// `with_coupling`: a coupling is bound.
  void update(const runtime::NodeHost& host, runtime::NodeRegistry& registry, std::uint64_t session,
              bool with_coupling);
  bool ready() const noexcept { return ready_.load(std::memory_order_acquire); }
  /// The nodes that are not ready; empty if all are.
  const std::string& missing() const noexcept { return missing_; }
  /// Ends the session; the first reason is kept.
  void lose(std::string why) {
    if (lost_.empty())
      lost_ = std::move(why);
  }
  /// The first lost peer and the reason.
  const std::string& lost() const noexcept { return lost_; }
  const std::set<bus::Guid>& participants() const noexcept { return peers_.participants(); }

 private:
  runtime::PeerSet peers_{{"rendering", "coupling", "logger", "validator"}};
  std::atomic<bool> ready_{false};
  std::string missing_, lost_;
};

}  // namespace voxtouch::device_node
