#pragma once
/// Parameters that may not jump while a hand pushes.
#include <algorithm>
#include <cmath>

namespace voxtouch::coupling {

/// Least time [s] over which a parameter that changes the displayed stiffness or damping goes from
/// one value to the next. A stiffness that rises by dk while pressed in by p gives the hand dk p^2
/// / 2, which the loop must have time to take.
inline constexpr double kMinRampS = 0.02;

/// The same where a filter with w0 [rad/s] stands behind: five of its times, if that is longer. w0
/// <= 0: there is none.
inline double ramp_behind_filter_s(double w0_rad_per_s) noexcept {
  return w0_rad_per_s > 0.0 ? std::max(5.0 / w0_rad_per_s, kMinRampS) : kMinRampS;
}

/// A finite number on its straight way to another. Real-time safe.
class Ramp {
 public:
  Ramp() = default;
  /// At rest at `value`.
  explicit Ramp(double value) noexcept : now_(value), goal_(value) {}

  /// From where it is to `goal` in `duration_s` > 0.
  void head_for(double goal, double duration_s) noexcept {
    goal_ = goal, rate_ = std::abs(goal - now_) / duration_s;
  }
  /// Moves on by `dt_s` [s] and gives the number as it is then.
  double advance(double dt_s) noexcept {
    if (now_ != goal_)
      now_ = std::clamp(goal_, now_ - rate_ * dt_s, now_ + rate_ * dt_s);
    return now_;
  }
  double now() const noexcept { return now_; }

 private:
  double now_ = 0.0, goal_ = 0.0, rate_ = 0.0;
};

}  // namespace voxtouch::coupling
