#pragma once
/// Joint rates from joint positions.
#include <cmath>
#include <numbers>

#include "devices/arm/joints.hpp"

namespace voxtouch::arm {

/// Backward difference, then a first-order low-pass:
///
///     rate += (1 - exp(-2 pi f dt)) (difference - rate)
///
/// Any dt is stable. At constant acceleration it lags by 1 / (2 pi f) to within a period.
/// Real-time safe.
class JointRates {
 public:
  /// `cutoff_hz`: f of the low-pass, > 0.
  explicit JointRates(double cutoff_hz) noexcept : per_s_(2.0 * std::numbers::pi * cutoff_hz) {}

  /// The rates [rad/s] with the positions `q` [rad], `dt_s` [s] after the last ones.
  const Joints& update(const Joints& q, double dt_s) noexcept {
    if (started_ && dt_s > 0.0)
      rate_ += (1.0 - std::exp(-per_s_ * dt_s)) * ((q - last_) / dt_s - rate_);
    started_ = true;
    last_ = q;
    return rate_;
  }
  /// Restarts at rest with the next position: after a gap a difference is not the present velocity.
  void restart() noexcept { started_ = false, rate_.setZero(); }
  const Joints& rate() const noexcept { return rate_; }

 private:
  double per_s_;
  bool started_ = false;
  Joints last_ = Joints::Zero(), rate_ = Joints::Zero();
};

}  // namespace voxtouch::arm
