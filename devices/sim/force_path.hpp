#pragma once
/// From the command to the force at the tool: saturation, delay, first-order lag.
#include <array>
#include <cstddef>

#include "devices/driver.hpp"

namespace voxtouch::sim {

/// Steps of the plant in one sample period.
inline constexpr int kSubsteps = 8;

/// A motor with its electronics. The command is cut to the device's limits (direction kept),
/// delayed by a whole number of substeps, and followed with a first-order lag. Real-time safe.
class ForcePath {
 public:
  static constexpr int kMaxDelayPeriods = 32;

  /// `device`: limits, delay (rounded to a whole substep, at most kMaxDelayPeriods), bandwidth.
  ForcePath(const DeviceDescription& device, double substep_s) noexcept;

  /// One substep with a constant `command`: the mean wrench at the tool.
  Wrench step(const Wrench& command) noexcept;
  /// Empties the delay line; zero force.
  void clear() noexcept;

  std::size_t delay_substeps() const noexcept { return delay_; }

 private:
  static constexpr std::size_t kSlots = std::size_t{kMaxDelayPeriods} * kSubsteps + 1;
  double max_force_n_, max_torque_nm_, follow_;
  std::size_t delay_, next_ = 0;
  std::array<Wrench, kSlots> line_{};
  Wrench lagged_;
};

}  // namespace voxtouch::sim
