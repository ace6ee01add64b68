#include "devices/sim/plant.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace voxtouch::sim {
namespace {

/// End velocity of a frictionless step, and how much force changes it by one unit.
struct FreeStep {
  Vec3 velocity, force_per_velocity;
};

FreeStep free_step(const Mobility& m, const Vec3& pull, const Vec3& target_velocity,
                   const Vec3& force, double dt_s, const Vec3& velocity) noexcept {
  const double half = 0.5 * dt_s;
  const Vec3 stiffened =
      m.mass + Vec3::Constant(half * (m.damping + m.hand_damping) + half * half * m.hand_stiffness);
  const Vec3 drive = force + m.hand_damping * target_velocity + m.hand_stiffness * pull;
  const Vec3 mean = (m.mass.cwiseProduct(velocity) + half * drive).cwiseQuotient(stiffened);
  return {2.0 * mean - velocity, stiffened / dt_s};
}

}  // namespace

Vec3 step_mobility(const Mobility& m, const Vec3& pull, const Vec3& target_velocity,
                   const Vec3& force, double dt_s, Vec3& velocity) noexcept {
  FreeStep free = free_step(m, pull, target_velocity, force, dt_s, velocity);
  if (m.friction > 0.0) {
    Vec3 needed = free.velocity.cwiseProduct(free.force_per_velocity);  // to end the step at rest
    if (needed.dot(velocity) < 0.0) {
      velocity.setZero();
      free = free_step(m, pull, target_velocity, force, dt_s, velocity);
      needed = free.velocity.cwiseProduct(free.force_per_velocity);
    }
    const double most = needed.norm();
    if (!(most > m.friction)) {
      velocity.setZero();
      return Vec3::Zero();
    }
    free.velocity *= 1.0 - m.friction / most;
  }
  const Vec3 mean = 0.5 * (velocity + free.velocity);
  velocity = free.velocity;
  return mean;
}

SimPlant::SimPlant(const SimParameters& p, const OperatorConfig& hand, Motion motion)
    : hand_(hand),
      motion_(std::move(motion)) {
  free_translation_ = {p.mass_kg, p.description.damping_ns_per_m, p.description.coulomb_friction_n,
                       0.0, 0.0};
  free_rotation_ = {Vec3::Constant(p.inertia_kg_m2), p.damping_nms_per_rad, p.coulomb_friction_nm,
                    0.0, 0.0};
  held_translation_ = free_translation_;
  held_translation_.mass += Vec3::Constant(hand.mass_kg);
  held_translation_.hand_damping = hand.damping_ns_per_m;
  held_translation_.hand_stiffness = hand.stiffness_n_per_m;
  held_rotation_ = free_rotation_;
  held_rotation_.mass += Vec3::Constant(hand.inertia_kg_m2);
  held_rotation_.hand_damping = hand.damping_nms_per_rad;
  held_rotation_.hand_stiffness = hand.stiffness_nm_per_rad;
  pose_ = {motion_at(motion_, 0.0).position, orientation_at(motion_, 0.0).orientation};
}

void SimPlant::be_led(double period_s, const DeviceDescription& device) noexcept {
  // The stiffest grip of the whole run.
  const double grip = hand_.grip_change_time_s < std::numeric_limits<double>::infinity()
                          ? std::max(1.0, hand_.grip_factor)
                          : 1.0;
  leader_.emplace(pose_, period_s,
                  hand::TargetFollower::Strength{device.max_force_n, device.max_torque_nm,
                                                 grip * hand_.stiffness_n_per_m,
                                                 grip * hand_.stiffness_nm_per_rad});
}

void SimPlant::step(const Wrench& device_wrench, const Vec3& tremor, double time_s,
                    double dt_s) noexcept {
  const bool held = held_at(time_s);
  const MotionPoint target = target_at(time_s + 0.5 * dt_s);
  const Vec3 force = held ? Vec3(device_wrench.force + tremor + carrying_force(target.velocity))
                          : device_wrench.force;
  pose_.position +=
      dt_s * step_mobility(held ? gripped(held_translation_, time_s) : free_translation_,
                           target.position - pose_.position, target.velocity, force, dt_s,
                           twist_.linear);
  const MotionOrientation angular = target_orientation_at(time_s + 0.5 * dt_s);
  const Vec3 rate = step_mobility(held ? gripped(held_rotation_, time_s) : free_rotation_,
                                  rotation_to(angular.orientation), angular.rate,
                                  device_wrench.torque, dt_s, twist_.angular);
  if (rate.isZero(0.0))
    return;  // no rotation: the quaternion stays bit-identical
  const Vec3 half_rotation =
      (0.5 * dt_s) * rate;  // the Cayley map: a rotation by 2 atan(|rate| dt / 2)
  pose_.orientation =
      (Quat(1.0, half_rotation.x(), half_rotation.y(), half_rotation.z()) * pose_.orientation)
          .normalized();
}

MotionPoint SimPlant::target_at(double time_s) const noexcept {
  return leader_ ? leader_->position_at(time_s) : motion_at(motion_, time_s);
}

MotionOrientation SimPlant::target_orientation_at(double time_s) const noexcept {
  return leader_ ? leader_->orientation_at(time_s) : orientation_at(motion_, time_s);
}

Vec3 SimPlant::carrying_force(const Vec3& target_velocity) const noexcept {
  if (!hand_.carries_tool)
    return Vec3::Zero();
  // Friction is full above 1 mm/s and proportional below, so the force has no step when the target
  // starts to move.
  const double fraction = free_translation_.friction / std::max(target_velocity.norm(), 1e-3);
  return (free_translation_.damping + fraction) * target_velocity;
}

Mobility SimPlant::gripped(Mobility held, double time_s) const noexcept {
  if (time_s < hand_.grip_change_time_s)
    return held;
  held.hand_damping *= hand_.grip_factor;
  held.hand_stiffness *= hand_.grip_factor;
  return held;
}

Vec3 SimPlant::rotation_to(const Quat& target) const noexcept {
  const Quat rotation = target * pose_.orientation.conjugate();
  return (rotation.w() < 0.0 ? -2.0 : 2.0) * rotation.vec();
}

double SimPlant::energy(double time_s) const noexcept {
  const bool held = held_at(time_s);
  const Mobility linear = held ? gripped(held_translation_, time_s) : free_translation_;
  const Mobility angular = held ? gripped(held_rotation_, time_s) : free_rotation_;
  const Vec3 off = target_at(time_s).position - pose_.position;
  const double cosine =
      std::abs((target_orientation_at(time_s).orientation * pose_.orientation.conjugate()).w());
  return 0.5 * (linear.mass.dot(twist_.linear.cwiseAbs2()) +
                angular.mass.dot(twist_.angular.cwiseAbs2()) +
                linear.hand_stiffness * off.squaredNorm()) +
         angular.hand_stiffness * 4.0 * (1.0 - cosine);
}

}  // namespace voxtouch::sim
