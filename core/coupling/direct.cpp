#include "core/coupling/direct.hpp"

namespace voxtouch {

void DirectCoupling::reset(const Wrench& held) noexcept {
  held_ = given_ = policy_.restart(held);
}

Wrench DirectCoupling::step(const CouplingInput& input, double dt_s) noexcept {
  const PolicedInput in = policy_.take(input, dt_s, 1.0);
  if (in.gap) held_ = given_;
  given_ = in.contact;
  if (in.weight < 1.0) {
    given_.force = in.weight * in.contact.force + (1.0 - in.weight) * held_.force;
    given_.torque = in.weight * in.contact.torque + (1.0 - in.weight) * held_.torque;
  }
  return given_;
}

}  // namespace voxtouch
