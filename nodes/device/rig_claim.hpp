#pragma once
/// Which of two devices keeps the rig.
#include <optional>
#include <string>

#include "nodes/runtime/node_registry.hpp"

namespace voxtouch::device_node {

/// Two devices of one rig: after a network split, or after a start at the same time, when neither
/// sees the other. Each publishes, once, how many of its samples had been answered when it first
/// saw the other. The one with more, whose ring is with it, stays; of equal ones that with the
/// smaller GUID. Neither number changes any more, so both decide alike, without a clock.
class RigClaim {
 public:
  /// `own`: this node's participant; `answered`: its samples so far. True where another device
  /// keeps the rig.
  bool update(const runtime::NodeRegistry& registry, const bus::Guid& own, std::uint64_t answered);
  /// Name of the other device; empty: there is none.
  const std::string& conflicting() const noexcept { return conflicting_; }
  void report_to(runtime::NodeReport& report) const;

 private:
  std::optional<std::uint64_t> claim_;
  std::string conflicting_;
};

}  // namespace voxtouch::device_node
