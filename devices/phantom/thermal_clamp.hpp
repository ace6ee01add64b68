#pragma once
/// Less force while motors are warm, so that the device need not drop it.
#include <algorithm>
#include <span>

namespace voxtouch::phantom {

/// A limit of the force's magnitude. Any motor over `kWarm`: it shrinks by a thousandth a tick from
/// what is being asked for, down to the continuous force. All under `kCool`: it grows by a
/// thousandth a tick, up to the maximum. Between the two it stays. The rule is the one that the
/// vendor publishes as an example. A temperature that is not finite counts as warm. Real-time safe.
class ThermalClamp {
 public:
  static constexpr double kWarm = 0.7, kCool = 0.5;  // 1: so hot that the device drops its force
  static constexpr double kShrink = 0.999, kGrow = 1.001;

  ThermalClamp(double max_n, double continuous_n) noexcept
      : max_n_(max_n),
        floor_n_(std::min(continuous_n, max_n)),
        limit_n_(max_n) {}

  /// Once a tick; no temperatures: no change. `asked_n`: magnitude of the force that was last set,
  /// 0 for none.
  double see(std::span<const double> temperatures, double asked_n) noexcept {
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
  /// What is left of the maximum, (0, 1].
  double fraction() const noexcept { return limit_n_ / max_n_; }

 private:
  double max_n_, floor_n_, limit_n_;
};

}  // namespace voxtouch::phantom
