#pragma once
/// The coupling that is none: what the other two are measured against.
#include "core/coupling/law_input.hpp"

namespace voxtouch::coupling {

/// Contact straight to the device. Real-time safe.
class DirectCoupling {
 public:
  /// The contact, faded in from the force given at the start: weight * contact + (1 - weight) *
  /// start, in N and Nm, W axes.
  Wrench step(const LawInput& in) noexcept {
    if (in.weight >= 1.0)
      return in.contact;
    return {in.weight * in.contact.force + (1.0 - in.weight) * start_.force,
            in.weight * in.contact.torque + (1.0 - in.weight) * start_.torque};
  }
  /// Starts again, giving `start`.
  void start_at(const Wrench& start) noexcept { start_ = start; }

 private:
  Wrench start_;
};

}  // namespace voxtouch::coupling
