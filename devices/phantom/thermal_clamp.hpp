#pragma once
/// Reduces the force while motors are warm, so that the device does not drop it.
#include <algorithm>
#include <span>

namespace voxtouch::phantom {

/// Limit of the force magnitude. Real-time safe.
/// If any motor is above `kWarm`, the limit falls to the last set force, then by a thousandth per
/// tick, down to the continuous force. If all are below `kCool`, it increases by a thousandth per
/// tick, up to the maximum. In between it is constant. The rule is an example published by the
/// vendor. A non-finite temperature counts as warm.
class ThermalClamp {
 public:
  static constexpr double kWarm = 0.7, kCool = 0.5;  // 1: the device drops its force
  static constexpr double kShrink = 0.999, kGrow = 1.001;

  ThermalClamp(double max_n, double continuous_n) noexcept
      : max_n_(max_n),
        floor_n_(std::min(continuous_n, max_n)),
        limit_n_(max_n) {}

  /// Call once per tick; without temperatures the limit is unchanged. `asked_n`: magnitude of the
  /// last set force, 0 without one.
  double update(std::span<const double> temperatures, double asked_n) noexcept {
    bool warm = false, cool = !temperatures.empty();
    for (const double t : temperatures) {
      warm = warm || !(t <= kWarm);
      cool = cool && t < kCool;
    }
    if (warm && asked_n > 0.0)
      limit_n_ = std::min(limit_n_, asked_n);
    if (warm)
      limit_n_ = std::max(floor_n_, limit_n_ * kShrink);
    if (cool)
      limit_n_ = std::min(max_n_, limit_n_ * kGrow);
    return limit_n_;
  }
  double limit_n() const noexcept { return limit_n_; }
  /// Present limit over the maximum, (0, 1].
  double fraction() const noexcept { return limit_n_ / max_n_; }

 private:
  double max_n_, floor_n_, limit_n_;
};

}  // namespace voxtouch::phantom
