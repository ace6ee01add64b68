#include "core/identification/holding_spring.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace voxtouch::identification {
namespace {

constexpr double kIntervalS = 0.2;
constexpr double kFilterHz = 100.0;
constexpr double kGrowth = 1.6;
constexpr double kFirstGain = 1.0 / 32.0, kMostGain = 2.0;
constexpr double kCatchS = 8e-3, kCatchSpeed = 0.02, kCatchM = 0.5e-3;

}  // namespace

void HoldingSpring::follow(const AxisModel& m, double period_s, double step,
                           double force_n) noexcept {
  const double filter_s = 1.0 / (2.0 * std::numbers::pi * kFilterHz);
  const double lag = m.delay_s + 1.8 * period_s + filter_s;
  // The forces of the encoder's noise and of 2 mm stay small compared with the limit.
  const double per_step = 0.1 * force_n / std::max(1e-9, step);
  damping_ = std::min(0.3 * m.mass_kg / lag, per_step * filter_s);
  // With much friction and little mass the spring must overcome the error of the friction.
  const double against_friction = std::min(0.05 * m.coulomb_n / 1e-3, 0.25 * damping_ / lag);
  stiffness_ = std::min({std::max(0.0225 * m.mass_kg / (lag * lag), against_friction), per_step,
                         force_n / 2e-3,
                         std::max(0.25 * damping_ * damping_ / m.mass_kg, against_friction)});
  gain_ = 1.0;
  follows_mass_ = true;
}

void HoldingSpring::sample(double time_s, double position_m, double step) noexcept {
  if (first_) {
    first_ = false;
    time_ = interval_start_ = time_s;
    position_ = low_ = high_ = rest_position_ = position_m;
    return;
  }
  const double dt = time_s - time_;
  if (dt > 0.0) {
    const double follow = -std::expm1(-2.0 * std::numbers::pi * kFilterHz * dt);
    velocity_ += follow * ((position_m - position_) / dt - velocity_);
  }
  time_ = time_s;
  position_ = position_m;
  low_ = std::min(low_, position_m);
  high_ = std::max(high_, position_m);
  if (!follows_mass_)
    catch_fall(time_s, step);
  if (time_s - interval_start_ >= kIntervalS)
    raise_gains(time_s, step);
}

void HoldingSpring::catch_fall(double time_s, double step) noexcept {
  const double away = position_ - rest_position_;
  if (std::abs(away) < std::max(kCatchM, 4.0 * step) || away * velocity_ <= 0.0)
    return;
  if (std::abs(velocity_) < kCatchSpeed || time_s - caught_s_ < kCatchS)
    return;
  caught_s_ = interval_start_ = time_s;  // from here on the fall grows
  low_ = high_ = position_;
  last_range_ = -1.0;
  gain_ = std::min(kMostGain, 2.0 * gain_);
}

void HoldingSpring::raise_gains(double time_s, double step) noexcept {
  const double range = high_ - low_;
  if (!follows_mass_) {
    const bool grows =
        last_range_ >= 0.0 && range > kGrowth * last_range_ && range > std::max(4.0 * step, 2e-4);
    gain_ = grows ? std::max(kFirstGain / 64.0, gain_ / 8.0)
                  : std::max(gain_, std::min(1.0, 2.0 * gain_));
  }
  last_range_ = range;
  interval_start_ = time_s;
  low_ = high_ = position_;
}

double HoldingSpring::force(double position_m, double velocity_m_per_s) const noexcept {
  return gain_ *
         (stiffness_ * (position_m - position_) + damping_ * (velocity_m_per_s - velocity_));
}

}  // namespace voxtouch::identification
