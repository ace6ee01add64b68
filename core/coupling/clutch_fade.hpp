#pragma once
/// What is left of the command while the clutch is pressed: the tool stays, the device moves free.
#include <algorithm>

#include "core/coupling/ramp.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::coupling {

/// Pressing fades the command out. With the release the coupling starts from what is left, and
/// fades its contact in (RunningCoupling::reset). Real-time safe.
class ClutchFade {
 public:
  static constexpr double kFadeS = 0.1;

  /// Of a sample `dt_s` after the last. True: the clutch has been released with it.
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
  /// What the device is to give of `wrench`.
  Wrench of(const Wrench& wrench) const noexcept { return pressed_ ? scaled(wrench) : wrench; }
  /// What it still gave of `wrench`, the last command, when the clutch was released.
  Wrench scaled(const Wrench& wrench) const noexcept {
    return {left_.now() * wrench.force, left_.now() * wrench.torque};
  }

 private:
  Ramp left_{0.0};
  bool pressed_ = false;
};

}  // namespace voxtouch::coupling
