#include "devices/fr3/torque_ramp.hpp"

#include <algorithm>
#include <cmath>

namespace voxtouch::fr3 {
namespace {

constexpr double kRounding = 1e-4;  // [Nm] floats of 60 Nm
constexpr int kMaxUnheard = 20;

}  // namespace

void TorqueRamp::acknowledge(const arm::Joints& tau_d) noexcept {
  const arm::Joints low = given_.cwiseMin(sent_), high = given_.cwiseMax(sent_);
  const bool arrived = !tau_d.allFinite() || (tau_d - sent_).cwiseAbs().maxCoeff() < kRounding;
  unheard_ = arrived ? 0 : unheard_ + 1;
  // A robot that has received no command for this long has stopped itself, so its report of the
  // received torque is not credible.
  given_ =
      arrived || unheard_ > kMaxUnheard ? sent_ : arm::Joints(tau_d.cwiseMax(low).cwiseMin(high));
}

const arm::Joints& TorqueRamp::next(const arm::Jacobian& jacobian, const Wrench& requested,
                                    const arm::Joints& posture) noexcept {
  Vec6 goal;
  goal << requested.force, requested.torque;
  const Vec6 displacement = goal - wrench_;
  const arm::Joints posture_displacement = posture - posture_;
  // The torque along the line is base + fraction * slope and must be within one step of the last
  // given torque.
  const arm::Joints base = jacobian.transpose() * wrench_ + posture_,
                    slope = jacobian.transpose() * displacement + posture_displacement;
  double fraction = 1.0;
  for (int i = 0; i < 7; ++i) {
    const double room =
        slope[i] > 0.0 ? step_nm_ - (base[i] - given_[i]) : step_nm_ + (base[i] - given_[i]);
    if (std::abs(slope[i]) > room)
      fraction = std::min(fraction, std::max(room, 0.0) / std::abs(slope[i]));
  }
  if (fraction >= 1.0)
    wrench_ = goal, posture_ = posture;
  else
    wrench_ += fraction * displacement, posture_ += fraction * posture_displacement;
  const arm::Joints torque =
      (jacobian.transpose() * wrench_ + posture_).cwiseMax(-most_nm_).cwiseMin(most_nm_);
  // The arm has moved under a constant force, which may itself change the torque by more than a
  // step.
  sent_ = torque.cwiseMax(given_ - arm::Joints::Constant(step_nm_))
              .cwiseMin(given_ + arm::Joints::Constant(step_nm_));
  return sent_;
}

void TorqueRamp::forget() noexcept {
  wrench_.setZero();
  posture_.setZero();
  sent_.setZero();
  given_.setZero();
}

}  // namespace voxtouch::fr3
