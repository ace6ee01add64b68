#pragma once
/// The direct coupling, a reference for the other two.
#include "core/coupling/law_input.hpp"

namespace voxtouch::coupling {

/// Passes the contact to the device unchanged. Real-time safe.
class DirectCoupling {
 public:
  /// The contact, faded in from the start force, W axes [N, Nm]:
  ///     weight * contact + (1 - weight) * start
  Wrench step(const LawInput& in) noexcept {
    if (in.weight >= 1.0)
      return in.contact;
    return {in.weight * in.contact.force + (1.0 - in.weight) * start_.force,
            in.weight * in.contact.torque + (1.0 - in.weight) * start_.torque};
  }
  /// Restarts from the force `start`.
  void start_at(const Wrench& start) noexcept { start_ = start; }

 private:
  Wrench start_;
};

}  // namespace voxtouch::coupling
