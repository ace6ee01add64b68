#pragma once
/// Parameters that must change continuously during contact.
#include <algorithm>
#include <cmath>

namespace voxtouch::coupling {

/// Minimum duration [s] of a change of displayed stiffness or damping. A stiffness that rises by dk
/// at penetration p adds the energy dk p^2 / 2, which the loop must have time to dissipate.
inline constexpr double kMinRampS = 0.02;

/// The same with a following filter of w0 [rad/s]: five of its time constants, if that is longer.
/// w0 <= 0: no filter.
inline double ramp_behind_filter_s(double w0_rad_per_s) noexcept {
  return w0_rad_per_s > 0.0 ? std::max(5.0 / w0_rad_per_s, kMinRampS) : kMinRampS;
}

/// A finite number that ramps linearly to a goal. Real-time safe.
class Ramp {
 public:
  Ramp() = default;
  /// Starts at rest at `value`.
  explicit Ramp(double value) noexcept : now_(value), goal_(value) {}

  /// Ramps from the present value to `goal` in `duration_s` > 0 [s].
  void head_for(double goal, double duration_s) noexcept {
    goal_ = goal, rate_ = std::abs(goal - now_) / duration_s;
  }
  /// Advances by `dt_s` [s] and returns the new value.
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
