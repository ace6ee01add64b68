#pragma once
/// Fades the command while the clutch is pressed: the tool stays in place and the device moves
/// freely.
#include <algorithm>

#include "core/coupling/ramp.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::coupling {

/// Pressing the clutch fades the command out. On release, the coupling starts from the faded
/// command and fades its contact in (RunningCoupling::reset). Real-time safe.
class ClutchFade {
 public:
  static constexpr double kFadeS = 0.1;  ///< duration of the fade [s]

  /// Advances by one sample of `dt_s` [s]. Returns true if the clutch was released with this
  /// sample.
  bool advance(bool pressed, double dt_s) noexcept {
    const bool released = pressed_ && !pressed;
    if (pressed && !pressed_)
      left_ = Ramp(1.0), left_.head_for(0.0, kFadeS);
    pressed_ = pressed;
    if (pressed)
      left_.advance(std::max(dt_s, 0.0));
    return released;
  }
  bool pressed() const noexcept { return pressed_; }
  /// The command `wrench` for the device: faded while the clutch is pressed, otherwise unchanged.
  Wrench of(const Wrench& wrench) const noexcept { return pressed_ ? scaled(wrench) : wrench; }
  /// The last command `wrench` as it was faded at the release of the clutch.
  Wrench scaled(const Wrench& wrench) const noexcept {
    return {left_.now() * wrench.force, left_.now() * wrench.torque};
  }

 private:
  Ramp left_{0.0};
  bool pressed_ = false;
};

}  // namespace voxtouch::coupling
