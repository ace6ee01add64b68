#include "devices/operator/target_follower.hpp"

#include <algorithm>
#include <cmath>

#include "core/types/lead_limit.hpp"

namespace voxtouch::hand {
namespace {

/// Displacement at which a spring gives the largest force; infinity if one of both is unlimited.
double full_lead(double largest, double stiffness) noexcept {
  return stiffness > 0.0 && largest > 0.0 ? largest / stiffness
                                          : std::numeric_limits<double>::infinity();
}

Vec3 load_of(const Vec3& force, double largest) noexcept {
  return largest > 0.0 ? Vec3(force / largest) : Vec3::Zero();
}

/// Rotation vector of length 2 sin(angle / 2), along the shorter rotation.
Vec3 chord_vector(const Quat& rotation) noexcept {
  return (rotation.w() < 0.0 ? -2.0 : 2.0) * rotation.vec();
}

Quat rotation_from_chord(const Vec3& vector) noexcept {
  const Vec3 half = 0.5 * vector;
  return Quat(std::sqrt(std::max(0.0, 1.0 - half.squaredNorm())), half.x(), half.y(), half.z());
}

}  // namespace

TargetFollower::TargetFollower(const Pose& start, double period_s,
                               const Strength& strength) noexcept
    : strength_(strength),
      period_s_(period_s),
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

void TargetFollower::advance(const Pose& tip, const Wrench& device_wrench) noexcept {
  ++periods_;
  if (since_target_ < rest_periods_)
    ++since_target_;
  if (periods_ % interval_ != 0)
    return;
  // The oldest step began kSteps intervals ago: it is done, and its place is free.
  Step& step = steps_[oldest_];
  base_.position += step.displacement;
  base_.orientation = (step.rotation * base_.orientation).normalized();
  step = begin_step(tip, device_wrench);
  goal_.position += step.displacement;
  goal_.orientation = (step.rotation * goal_.orientation).normalized();
  oldest_ = (oldest_ + 1) % kSteps;
}

Pose TargetFollower::within_reach(const Pose& requested, const Pose& tip,
                                  const Wrench& device_wrench) const noexcept {
  Pose reached = requested;
  const Vec3 displacement = requested.position - tip.position;
  const Vec3 limited_displacement =
      limited_lead(displacement, load_of(device_wrench.force, strength_.force_n),
                   full_lead(strength_.force_n, strength_.stiffness_n_per_m));
  if (limited_displacement != displacement)
    reached.position = tip.position + limited_displacement;
  const Vec3 rotation = chord_vector(requested.orientation * tip.orientation.conjugate());
  const Vec3 limited_rotation =
      limited_lead(rotation, load_of(device_wrench.torque, strength_.torque_nm),
                   full_lead(strength_.torque_nm, strength_.stiffness_nm_per_rad));
  if (limited_rotation != rotation)
    reached.orientation = (rotation_from_chord(limited_rotation) * tip.orientation).normalized();
  return reached;
}

TargetFollower::Step TargetFollower::begin_step(const Pose& tip,
                                                const Wrench& device_wrench) const noexcept {
  Step step;
  step.start_s = static_cast<double>(periods_) * period_s_;
  const Pose target =
      within_reach(since_target_ < rest_periods_ ? target_ : goal_, tip, device_wrench);
  const double interval_s = static_cast<double>(interval_) * period_s_;
  const auto cut = [](const Vec3& whole, double most) -> Vec3 {
    const double length = whole.stableNorm();
    return length > most ? Vec3((most / length) * whole) : whole;
  };
  step.displacement = cut(target.position - goal_.position, kMaxSpeedMPerS * interval_s);
  if (target.orientation.coeffs() == goal_.orientation.coeffs())
    return step;
  // sin(angle / 2) approximates angle / 2; the relative error is below 6e-5 for a limited rotation.
  step.rotation =
      rotation_from_chord(cut(chord_vector(target.orientation * goal_.orientation.conjugate()),
                              kMaxRateRadPerS * interval_s));
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

/// A fraction of a rotation is the normalised chord between rest and the whole rotation. With (w,
/// v) the whole rotation and x the fraction, the half angle has the tangent x |v| / (1 - x + x w),
/// so
/// angle' = 2 |v| x' / ((1 - x + x w)^2 + (x |v|)^2).
MotionOrientation TargetFollower::orientation_at(double time_s) const noexcept {
  MotionOrientation at{base_.orientation, Vec3::Zero()};
  for_each_step(time_s, [&](const Step& step, double fraction, double rate) {
    const Vec3 v = step.rotation.vec();
    if (v.isZero(0.0))
      return;
    const double scalar = 1.0 - fraction + fraction * step.rotation.w();
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
