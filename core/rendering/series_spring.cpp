#include "core/rendering/series_spring.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/types/rotation_vector.hpp"

namespace voxtouch::rendering {
namespace {

Vec6 diagonal(const Compliance& c) noexcept {
  return (Vec6() << Vec3::Constant(c.translation), Vec3::Constant(c.rotation)).finished();
}

Quat rotated_by(const Vec3& rotation, const Quat& from) noexcept {
  const double angle = rotation.norm();
  if (!(angle > 0.0))
    return from;
  return (Quat(Eigen::AngleAxisd(angle, rotation / angle)) * from).normalized();
}

}  // namespace

Mat6 in_series(const Mat6& stiffness, const Compliance& spring) noexcept {
  if (spring.rigid() || stiffness.isZero(0.0))
    return stiffness;
  Mat6 system = stiffness * diagonal(spring).asDiagonal();
  system.diagonal().array() += 1.0;
  const Mat6 both = system.partialPivLu().solve(stiffness);
  return 0.5 * (both + both.transpose());
}

void SeriesSpring::set_target(const Compliance& spring) noexcept {
  if (spring == goal_)
    return;
  goal_ = spring;
  if (fresh_) {
    now_ = spring;
    translation_ = coupling::Ramp(spring.translation), rotation_ = coupling::Ramp(spring.rotation);
  } else {
    translation_.head_for(spring.translation, kRampS), rotation_.head_for(spring.rotation, kRampS);
  }
}

void SeriesSpring::reset() noexcept {
  known_ = bracketed_ = false, fresh_ = true;
  now_ = goal_;
  translation_ = coupling::Ramp(goal_.translation), rotation_ = coupling::Ramp(goal_.rotation);
}

const Pose& SeriesSpring::begin(const Pose& hand, double dt_s) noexcept {
  now_ = {translation_.advance(dt_s), rotation_.advance(dt_s)};
  const bool jumped =
      !fresh_ && ((hand.position - hand_.position).norm() > kJumpM ||
                  rotation_vector(hand_.orientation, hand.orientation).norm() > kJumpRad);
  fresh_ = false;
  hand_ = hand;
  lookups_ = 0;
  if (!known_ || jumped) {
    last_ = {hand, {}}, wrench_ = {}, tool_ = hand;
    known_ = true, bracketed_ = false;
  } else {
    predict();
  }
  return tool_;
}

/// Difference between the forces of contact and spring, with the tool at `place`.
Vec3 SeriesSpring::residual(const Place& place) const noexcept {
  return place.contact.wrench.force - (place.tool.position - hand_.position) / now_.translation;
}

void SeriesSpring::predict() noexcept {
  if (bracketed_ && lookups_ != 1 && between())
    return;
  if (lookups_ != 1)
    bracketed_ = false;
  const ContactAt& at = last_.contact;
  const Vec6 displacement = (Vec6() << hand_.position - last_.tool.position,
                             rotation_vector(last_.tool.orientation, hand_.orientation))
                                .finished();
  Vec6 w = (Vec6() << at.wrench.force, at.wrench.torque).finished() - at.stiffness * displacement;
  if (!at.stiffness.isZero(0.0)) {
    Mat6 system = at.stiffness * diagonal(now_).asDiagonal();
    system.diagonal().array() += 1.0;
    w = system.partialPivLu().solve(w).eval();
  }
  wrench_ = {w.head<3>(), w.tail<3>()};
  tool_.position = hand_.position + now_.translation * wrench_.force;
  tool_.orientation = now_.rotation > 0.0
                          ? rotated_by(now_.rotation * wrench_.torque, hand_.orientation)
                          : hand_.orientation;
}

/// Places the tool between the last place and the one on the other side. Returns false if they do
/// not bracket the equilibrium.
bool SeriesSpring::between() noexcept {
  const Vec3 displacement = last_.tool.position - other_.tool.position;
  const double here = residual(last_).dot(displacement), there = residual(other_).dot(displacement);
  if (!(here * there < 0.0))
    return false;
  const double part = std::clamp(here / (here - there), 0.2, 0.8);
  tool_.position = last_.tool.position - part * displacement;
  tool_.orientation = hand_.orientation;
  if (now_.rotation > 0.0)
    tool_.orientation = last_.tool.orientation;
  wrench_.force = (tool_.position - hand_.position) / now_.translation;
  return true;
}

bool SeriesSpring::settle(const ContactAt& contact) noexcept {
  ++lookups_;
  if (!contact.wrench.finite() || !contact.stiffness.allFinite()) {
    wrench_ = {}, known_ = bracketed_ = false;
    return false;
  }
  const Place before = last_;
  last_ = {tool_, contact};
  // Only a compliant axis is of interest: a rigid one uses the contact's value.
  if (!(now_.translation > 0.0))
    wrench_.force = contact.wrench.force;
  if (!(now_.rotation > 0.0))
    wrench_.torque = contact.wrench.torque;
  const double force = wrench_.force.norm(), torque = wrench_.torque.norm();
  const bool balanced =
      (contact.wrench.force - wrench_.force).norm() <= kBalance * force + kSettledN &&
      (contact.wrench.torque - wrench_.torque).norm() <= kBalance * torque + kSettledNm;
  if (balanced) {
    // The force is so small that the spring's may point the other way; the contact's value is
    // equally good.
    if (force <= kSettledN)
      wrench_.force = contact.wrench.force;
    if (torque <= kSettledNm)
      wrench_.torque = contact.wrench.torque;
    bracketed_ = false;
    return false;
  }
  if (now_.translation > 0.0) {
    const Vec3 displacement = tool_.position - before.tool.position;
    if (residual(before).dot(displacement) * residual(last_).dot(displacement) < 0.0)
      other_ = before, bracketed_ = true;
    // At a step of the contact, between two nearly equal places: the spring holds the tool there.
    if (bracketed_ &&
        (last_.tool.position - other_.tool.position).norm() <= kSettledN * now_.translation)
      return false;
  }
  if (lookups_ >= kMaxLookups)
    return false;
  predict();
  return true;
}

}  // namespace voxtouch::rendering
