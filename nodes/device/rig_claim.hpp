#pragma once
/// Decides which of two devices keeps the rig.
#include <optional>
#include <string>

#include "nodes/runtime/node_registry.hpp"

namespace voxtouch::device_node {

/// Resolves a conflict of two devices in one rig.
/// It occurs after a network split, or if both start at the same time without seeing each other.
/// Each device publishes, once, how many of its samples had been answered when it first detected
/// the other. The device with the larger number keeps the rig; for equal numbers it is the one with
/// the smaller GUID. Neither number changes afterwards, so both devices decide alike without a
/// clock.
class RigClaim {
 public:
  /// `own`: participant of this node. `answered`: its answered samples so far. Returns true if
  /// another device keeps the rig.
  bool update(const runtime::NodeRegistry& registry, const bus::Guid& own, std::uint64_t answered);
  /// Name of the other device; empty if there is none.
  const std::string& conflicting() const noexcept { return conflicting_; }
  void report_to(runtime::NodeReport& report) const;

 private:
  std::optional<std::uint64_t> claim_;
  std::string conflicting_;
};

}  // namespace voxtouch::device_node
