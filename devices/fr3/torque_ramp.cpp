#include "devices/fr3/torque_ramp.hpp"

#include <algorithm>
#include <cmath>

namespace voxtouch::fr3 {
namespace {

constexpr double kRounding = 1e-4;  // [Nm] floats of 60 Nm
constexpr int kMaxUnheard = 20;

}  // namespace

void TorqueRamp::told(const arm::Joints& tau_d) noexcept {
  const arm::Joints low = given_.cwiseMin(sent_), high = given_.cwiseMax(sent_);
  const bool arrived = !tau_d.allFinite() || (tau_d - sent_).cwiseAbs().maxCoeff() < kRounding;
  unheard_ = arrived ? 0 : unheard_ + 1;
  // A robot that has heard nothing for so long has stopped itself: this one does not say what it
  // was told.
  given_ =
      arrived || unheard_ > kMaxUnheard ? sent_ : arm::Joints(tau_d.cwiseMax(low).cwiseMin(high));
}

const arm::Joints& TorqueRamp::next(const arm::Jacobian& jacobian, const Wrench& wanted,
                                    const arm::Joints& posture) noexcept {
  Vec6 goal;
  goal << wanted.force, wanted.torque;
  const Vec6 way = goal - wrench_;
  const arm::Joints posture_way = posture - posture_;
  // Torque along the way is base + share * slope, to be within a step of what was given.
  const arm::Joints base = jacobian.transpose() * wrench_ + posture_,
                    slope = jacobian.transpose() * way + posture_way;
  double share = 1.0;
  for (int i = 0; i < 7; ++i) {
    const double room =
        slope[i] > 0.0 ? step_nm_ - (base[i] - given_[i]) : step_nm_ + (base[i] - given_[i]);
    if (std::abs(slope[i]) > room)
      share = std::min(share, std::max(room, 0.0) / std::abs(slope[i]));
  }
  if (share >= 1.0)
    wrench_ = goal, posture_ = posture;
  else
    wrench_ += share * way, posture_ += share * posture_way;
  const arm::Joints torque =
      (jacobian.transpose() * wrench_ + posture_).cwiseMax(-most_nm_).cwiseMin(most_nm_);
  // The arm has moved under a force that stays: what that adds may be a step of its own.
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
