#include "devices/operator/target_follower.hpp"

#include <algorithm>
#include <cmath>

namespace voxtouch::hand {

TargetFollower::TargetFollower(const Pose& start, double period_s) noexcept
    : period_s_(period_s),
      interval_(static_cast<std::uint64_t>(
          std::max(1LL, std::llround(kStepS / (static_cast<double>(kSteps) * period_s))))),
      rest_periods_(static_cast<std::uint64_t>(std::llround(kRestS / period_s))),
      since_target_(rest_periods_),
      base_(start),
      goal_(start),
      target_(start) {
  step_s_ = static_cast<double>(kSteps * interval_) * period_s;
}

void TargetFollower::aim(const Pose& target) noexcept {
  Quat orientation = target.orientation;
  if (!target.position.allFinite() || !normalise_within(orientation, 1e-3, 1e3))
    return;
  target_ = {target.position, orientation};
  since_target_ = 0;
}

void TargetFollower::advance() noexcept {
  ++periods_;
  if (since_target_ < rest_periods_)
    ++since_target_;
  if (periods_ % interval_ != 0)
    return;
  // The oldest step began kSteps intervals ago: it is done, and its place is free.
  Step& step = steps_[oldest_];
  base_.position += step.displacement;
  base_.orientation = (step.turn * base_.orientation).normalized();
  step = begin_step();
  goal_.position += step.displacement;
  goal_.orientation = (step.turn * goal_.orientation).normalized();
  oldest_ = (oldest_ + 1) % kSteps;
}

TargetFollower::Step TargetFollower::begin_step() const noexcept {
  Step step;
  step.start_s = static_cast<double>(periods_) * period_s_;
  if (since_target_ >= rest_periods_)
    return step;
  const double interval_s = static_cast<double>(interval_) * period_s_;
  const auto cut = [](const Vec3& whole, double most) -> Vec3 {
    const double length = whole.norm();
    return length > most ? Vec3((most / length) * whole) : whole;
  };
  step.displacement = cut(target_.position - goal_.position, kMaxSpeedMPerS * interval_s);
  if (target_.orientation.coeffs() == goal_.orientation.coeffs())
    return step;
  const Quat whole = target_.orientation * goal_.orientation.conjugate();
  const double sign = whole.w() < 0.0 ? -1.0 : 1.0;
  // The sine of half the angle stands for half the angle: 6e-5 of it in a turn that is cut.
  const Vec3 half = cut(sign * whole.vec(), 0.5 * kMaxRateRadPerS * interval_s);
  step.turn =
      Quat(std::sqrt(std::max(0.0, 1.0 - half.squaredNorm())), half.x(), half.y(), half.z());
  return step;
}

template <class Use>
void TargetFollower::for_each_step(double time_s, Use&& use) const noexcept {
  for (std::size_t n = 0; n < kSteps; ++n) {
    const Step& step = steps_[(oldest_ + n) % kSteps];
    const double s = std::clamp((time_s - step.start_s) / step_s_, 0.0, 1.0);
    use(step, s * s * s * (10.0 + s * (-15.0 + 6.0 * s)),
        30.0 * s * s * (1.0 - s) * (1.0 - s) / step_s_);
  }
}

MotionPoint TargetFollower::position_at(double time_s) const noexcept {
  MotionPoint at{base_.position, Vec3::Zero()};
  for_each_step(time_s, [&](const Step& step, double fraction, double rate) {
    at.position += fraction * step.displacement;
    at.velocity += rate * step.displacement;
  });
  return at;
}

/// A part of a turn is the chord between rest and the whole of it, brought back to length 1. With
/// (w, v) the whole turn and x the fraction, the half angle has the tangent x |v| / (1 - x + x w),
/// so
///
///   angle' = 2 |v| x' / ((1 - x + x w)^2 + (x |v|)^2).
MotionTurnPoint TargetFollower::turn_at(double time_s) const noexcept {
  MotionTurnPoint at{base_.orientation, Vec3::Zero()};
  for_each_step(time_s, [&](const Step& step, double fraction, double rate) {
    const Vec3 v = step.turn.vec();
    if (v.isZero(0.0))
      return;
    const double scalar = 1.0 - fraction + fraction * step.turn.w();
    const Vec3 vector = fraction * v;
    const double norm2 = scalar * scalar + vector.squaredNorm();
    const Quat part = Quat(scalar, vector.x(), vector.y(), vector.z()).normalized();
    at.orientation = part * at.orientation;
    at.rate = part * at.rate + (2.0 * rate / norm2) * v;
  });
  if (at.orientation.coeffs() != base_.orientation.coeffs())
    at.orientation.normalize();
  return at;
}

}  // namespace voxtouch::hand
