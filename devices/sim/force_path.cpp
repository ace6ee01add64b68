#include "devices/sim/force_path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/types/clamp.hpp"

namespace voxtouch::sim {

ForcePath::ForcePath(const DeviceDescription& device, double substep_s) noexcept
    : max_force_n_(device.max_force_n),
      max_torque_nm_(device.max_torque_nm) {
  const double substeps =
      std::clamp(std::round(device.delay_s / substep_s), 0.0, double{kSlots - 1});
  delay_ = static_cast<std::size_t>(substeps);
  // Pade(1,1) of 1 - exp(-dt/tau). It uses no library function, whose last bit may differ between
  // machines. tau = 0 would give 2, a filter that alternates; the factor is limited to 1: no lag.
  const double tau_s = 1.0 / (2.0 * std::numbers::pi * device.force_bandwidth_hz);
  follow_ = std::min(1.0, substep_s / (tau_s + 0.5 * substep_s));
}

Wrench ForcePath::step(const Wrench& command) noexcept {
  Wrench& in = line_[next_];
  in = command;
  clamp_wrench(in, max_force_n_, max_torque_nm_);
  const Wrench& out = line_[(next_ + kSlots - delay_) % kSlots];
  next_ = (next_ + 1) % kSlots;
  if (follow_ >= 1.0)
    return lagged_ = out;
  const Wrench before = lagged_;
  lagged_.force += follow_ * (out.force - before.force);
  lagged_.torque += follow_ * (out.torque - before.torque);
  return {0.5 * (before.force + lagged_.force), 0.5 * (before.torque + lagged_.torque)};
}

void ForcePath::clear() noexcept {
  line_.fill({});
  lagged_ = {};
}

}  // namespace voxtouch::sim
