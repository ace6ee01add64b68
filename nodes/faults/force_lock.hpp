#pragma once
/// After some faults the force stays at zero until the operator resets the lock.
#include <atomic>
#include <cstdint>
#include <string>

#include "nodes/bus/reader.hpp"
#include "nodes/runtime/node_registry.hpp"

namespace voxtouch::faults {

/// Latches a fault at zero force until a reset.
/// The loop engages the lock and checks for its reset; the monitor reports it and passes the reset
/// on. Each engagement has a new number, so a reset applies to one engagement only. A recorded
/// reset has no effect.
class ForceLock {
 public:
  ForceLock();

  /// Called by the loop; real-time safe. `reason`: a sentence without its full stop, with static
  /// lifetime.
  void engage(const char* reason) noexcept;
  bool engaged() const noexcept { return number_.load(std::memory_order_acquire) != 0; }
  /// Returns true once after the engaged lock has been reset.
  bool opened() noexcept;

  /// Called by another thread. A number other than that of the engaged lock has no effect.
  void open(std::uint64_t number) noexcept { asked_.store(number, std::memory_order_release); }
  /// Adds the lock to a status. While the node runs, the request for a reset replaces any other
  /// message.
  void report_to(runtime::NodeReport& report, bool runs = true) const;

  static constexpr char kNumber[] = "lock", kReason[] = "locked_because", kCount[] = "locks";

 private:
  std::uint64_t state_;  ///< state of the number generator, loop only
  std::atomic<std::uint64_t> number_{0}, asked_{0}, count_{0};
  std::atomic<const char*> reason_{nullptr};
};

/// Receives resets for the nodes of a rig. Used by the monitor thread.
class LockKeeper {
 public:
  LockKeeper(const bus::Participant& participant, const std::string& rig);
  /// Resets `lock` if its number was received in this session.
  void listen(std::uint64_t session, ForceLock& lock);

 private:
  bus::Reader<msg::Recover> words_;
};

}  // namespace voxtouch::faults
