#pragma once
/// After some faults the force stays at zero until the operator resets the latch.
#include <atomic>
#include <cstdint>
#include <string>

#include "nodes/bus/reader.hpp"
#include "nodes/runtime/node_registry.hpp"

namespace voxtouch::faults {

/// Latches a fault at zero force until a reset.
/// The loop latches a fault and checks for its reset; the monitor reports it and passes the reset
/// on. Each fault has a new number, so a reset applies to one fault only. A recorded
/// reset has no effect.
class FaultLatch {
 public:
  FaultLatch();

  /// Called by the loop; real-time safe. `reason`: a sentence without its full stop, with static
  /// lifetime.
  void latch(const char* reason) noexcept;
  bool latched() const noexcept { return number_.load(std::memory_order_acquire) != 0; }
  /// Returns true once after the latch has been reset.
  bool take_reset() noexcept;

  /// Called by another thread. A number other than that of the latched fault has no effect.
  void reset(std::uint64_t number) noexcept {
    reset_number_.store(number, std::memory_order_release);
  }
  /// Adds the latch to a status. While the node runs, the request for a reset replaces any other
  /// message.
  void report_to(runtime::NodeReport& report, bool runs = true) const;

  static constexpr char kNumber[] = "fault_latch", kReason[] = "fault_reason",
                        kCount[] = "fault_latches";

 private:
  std::uint64_t state_;  ///< state of the number generator, loop only
  std::atomic<std::uint64_t> number_{0}, reset_number_{0}, count_{0};
  std::atomic<const char*> reason_{nullptr};
};

/// Receives resets for the nodes of a rig. Used by the monitor thread.
class ResetReceiver {
 public:
  ResetReceiver(const bus::Participant& participant, const std::string& rig);
  /// Resets `latch` if its number was received in this session.
  void receive(std::uint64_t session, FaultLatch& latch);

 private:
  bus::Reader<msg::Recover> resets_;
};

}  // namespace voxtouch::faults
