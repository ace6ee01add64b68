#pragma once
/// Velocity from poses. The smoothing of the library's own velocity is not published, so it is not
/// used.
#include <numbers>

#include "core/types/rotation_vector.hpp"

namespace voxtouch::phantom {

/// Backward difference over the elapsed time, then a first-order low-pass by backward Euler:
///
///     twist += w dt / (1 + w dt) (difference - twist),   w = 2 pi cutoff_hz
///
/// Any dt is stable. At constant acceleration the twist lags by half a period (the difference) and
/// 1 / w (the low-pass). Axes of the outer frame. Real-time safe.
class TwistEstimate {
 public:
  /// `cutoff_hz`: cut-off of the low-pass, > 0.
  explicit TwistEstimate(double cutoff_hz) noexcept : per_s_(2.0 * std::numbers::pi * cutoff_hz) {}

  /// The twist [m/s, rad/s] at `pose`, `dt_s` [s] after the last one.
  const Twist& update(const Pose& pose, double dt_s) noexcept {
    if (started_ && dt_s > 0.0) {
      const double follow = per_s_ * dt_s / (1.0 + per_s_ * dt_s);
      twist_.linear += follow * ((pose.position - last_.position) / dt_s - twist_.linear);
      twist_.angular +=
          follow * (rotation_vector(last_.orientation, pose.orientation) / dt_s - twist_.angular);
    }
    started_ = true;
    last_ = pose;
    return twist_;
  }
  /// Restarts at rest with the next pose: after a gap a difference is not the present velocity.
  void restart() noexcept { started_ = false, twist_ = {}; }

 private:
  double per_s_;
  bool started_ = false;
  Pose last_;
  Twist twist_;
};

}  // namespace voxtouch::phantom
