#pragma once
/// Waits until one of several readers has a sample.
#include "nodes/bus/participant.hpp"

namespace voxtouch::bus {

class WaitSet {
 public:
  explicit WaitSet(const Participant& participant);
  /// Attaches a reader's condition. Throws Error.
  void attach(dds_entity_t condition);
  /// Returns true when a condition triggers, false after `timeout`. Makes no allocation outside
  /// DDS.
  bool wait(dds_duration_t timeout) noexcept;

 private:
  Entity entity_;
};

}  // namespace voxtouch::bus
