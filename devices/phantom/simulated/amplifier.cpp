#include "devices/phantom/simulated/amplifier.hpp"

#include <algorithm>

#include "core/types/clamp.hpp"

namespace voxtouch::hd_sim {
namespace {

constexpr double kCool = 0.9;  // an overheated motor works again below this: assumed

}  // namespace

Amplifier::Amplifier(const Model& model, const PlantConfig& plant, double thermal_time_s,
                     double watchdog_s) noexcept
    : model_(&model),
      geometry_(plant.geometry),
      motor_limit_(plant.motor_limit_nm),
      continuous_(model.continuous_force_n *
                  Vec3(geometry_.thigh_m, geometry_.thigh_m, geometry_.shin_m)),
      thermal_time_s_(thermal_time_s),
      watchdog_s_(watchdog_s) {}

phantom::hd::HDerror Amplifier::begin_tick(const Reading& reading, double period_s) noexcept {
  ceiling_n_ = std::min(ceiling_n_ + limits.ramp_n_per_s * period_s, 1e6);
  const bool was_warm = warm_, was_too_fast = too_fast_;
  warm_ = temperature_.maxCoeff() >= (was_warm ? kCool : 1.0);
  too_fast_ =
      limits.velocity_limit_on && reading.twist.linear.norm() > limits.velocity_limit_m_per_s;
  if (dropping())
    drop(phantom::hd::kSuccess);  // the ramp starts when the cause has ended
  if (warm_ && !was_warm)
    return phantom::hd::kWarmMotors;
  return too_fast_ && !was_too_fast && limits.force_output ? phantom::hd::kExceededMaxVelocity
                                                           : phantom::hd::kSuccess;
}

phantom::hd::HDerror Amplifier::drop(phantom::hd::HDerror code) noexcept {
  release();
  ceiling_n_ = 0.0;
  return code;
}

phantom::hd::HDerror Amplifier::limit(Vec3& force, double period_s) noexcept {
  if (limits.clamping)
    clamp_length(force, model_->max_force_n);
  if (limits.force_limit && force.norm() > model_->max_force_n)
    return drop(phantom::hd::kExceededMaxForce);
  if (limits.ramping)
    clamp_length(force, ceiling_n_);
  const double per_ms = (force - force_).norm() / (1e3 * period_s);
  if (limits.impulse_limit_on && per_ms > limits.impulse_limit_n_per_ms)
    return drop(phantom::hd::kExceededMaxForceImpulse);
  force_ = force;
  return phantom::hd::kSuccess;
}

phantom::hd::HDerror Amplifier::flush(const Setpoint& setpoint, const Reading& reading,
                                      double period_s) noexcept {
  age_s_ = 0.0;
  if (!limits.force_output || !power_ || dropping()) {
    release();
    return phantom::hd::kSuccess;
  }
  const Mat3 j = phantom::phantom_jacobian(geometry_, reading.joints);
  Vec3 force = setpoint.force.value_or(Vec3::Zero());
  const phantom::hd::HDerror verdict = limit(force, period_s);
  if (verdict == phantom::hd::kSuccess)
    torque_ = j.transpose() * force;
  return verdict;
}

const Vec3& Amplifier::advance(double dt_s) noexcept {
  age_s_ += dt_s;
  if (age_s_ > watchdog_s_ + 0.5 * dt_s)
    release();
  // The heat of a motor is proportional to its squared torque; constant continuous torque converges
  // to 1.
  const Vec3 heat =
      torque_.cwiseMin(motor_limit_).cwiseMax(-motor_limit_).cwiseQuotient(continuous_).cwiseAbs2();
  temperature_ += (dt_s / thermal_time_s_) * (heat - temperature_);
  return torque_;
}

void Amplifier::release() noexcept {
  torque_.setZero();
  force_.setZero();
}

void Amplifier::restart_ramp() noexcept {
  release();
  ceiling_n_ = 0.0;
}

void Amplifier::set_power(bool on) noexcept {
  power_ = on;
  if (!on)
    release();
}

}  // namespace voxtouch::hd_sim
