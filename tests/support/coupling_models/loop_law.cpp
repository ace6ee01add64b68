#include "tests/support/coupling_models/loop_law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace voxtouch::coupling_models {
namespace {

constexpr double kSoftSlope = 0.3;

}  // namespace

double wall_effort(WallLaw law, double stiffness, double knee, double position) noexcept {
  const double depth = std::max(0.0, position), shallow = std::min(depth, knee),
               beyond = depth - shallow;
  switch (law) {
    case WallLaw::kBilateral:
      return stiffness * position;
    case WallLaw::kUnilateral:
      return stiffness * depth;
    case WallLaw::kSoftening:
      return stiffness * (shallow + kSoftSlope * beyond);
    case WallLaw::kHardening:
      return stiffness * (kSoftSlope * shallow + beyond);
  }
  return 0.0;
}

LoopLaw::LoopLaw(const NonlinearLoop& loop)
    : controller_(loop.controller),
      wall_(loop.wall),
      knee_(loop.wall_knee),
      damping_fraction_(loop.damping_fraction),
      damping_free_(loop.damping_free),
      max_effort_(loop.max_effort > 0.0 ? loop.max_effort
                                        : std::numeric_limits<double>::infinity()),
      input_limit_(controller_.law == coupling::design::LoopController::Law::kSpringDamper
                       ? std::numeric_limits<double>::infinity()
                       : max_effort_ / std::abs(controller_.gain)),
      nominal_s_(loop.plant.period_s),
      slow_rad_per_s_(loop.slow_velocity_rad_per_s),
      velocity_band_(loop.velocity_band),
      only_in_contact_(loop.damping_only_in_contact),
      measured_period_(loop.measured_period) {
  if (controller_.law == coupling::design::LoopController::Law::kShapingFilter)
    filter_ = Pt2(controller_.w0_rad_per_s, controller_.damping_ratio, controller_.gain);
}

/// Slope of the last n periods plus half of its excess over that of the 2 n before; at rest before
/// the first.
double LoopLaw::velocity_of_window(double position, double period_s) {
  const std::size_t n = static_cast<std::size_t>(controller_.velocity_window);
  if (past_.empty())
    past_.assign(3 * n + 1, {last_position_, period_s});
  past_.emplace_front(position, period_s);
  past_.pop_back();
  const auto slope = [&](std::size_t from, std::size_t to) {
    double time = 0.0;
    for (std::size_t i = from; i < to; ++i)
      time += past_[i].second;
    return (past_[from].first - past_[to].first) / time;
  };
  return 1.5 * slope(0, n) - 0.5 * slope(n, 3 * n);
}

double LoopLaw::filtered(double rad_per_s, double before, double difference,
                         double period_s) const {
  const double decay =
      rad_per_s > 0.0 ? std::exp(-rad_per_s * (measured_period_ ? period_s : nominal_s_)) : 0.0;
  return decay * before + (1.0 - decay) * difference;
}

double LoopLaw::velocity(double position, double period_s) {
  const double difference = (position - last_position_) / period_s;
  velocity_ = controller_.velocity_window > 0 ? velocity_of_window(position, period_s)
                                              : filtered(controller_.velocity_filter_rad_per_s,
                                                         velocity_, difference, period_s);
  last_position_ = position;
  if (!(velocity_band_ > 0.0))
    return velocity_;
  slow_velocity_ = filtered(slow_rad_per_s_, slow_velocity_, difference, period_s);
  return velocity_ + std::clamp(slow_velocity_ - velocity_, -velocity_band_, velocity_band_);
}

double LoopLaw::coupled(double wall, double stiffness, double period_s) noexcept {
  switch (controller_.law) {
    case coupling::design::LoopController::Law::kShapingFilter:
      return filter_.step(std::clamp(wall, -input_limit_, input_limit_), period_s);
    case coupling::design::LoopController::Law::kDirect:
      return controller_.gain * std::clamp(wall, -input_limit_, input_limit_);
    case coupling::design::LoopController::Law::kSpringDamper:
      break;
  }
  if (wall_ != WallLaw::kBilateral)
    return spring_damper_
        .step({wall, 0.0, 0.0}, stiffness, controller_.stiffness, controller_.damping, period_s)
        .x();
  const double damper = controller_.damping / period_s;  // the same law with a bilateral contact
  offset_ = (wall + damper * offset_) / (stiffness + controller_.stiffness + damper);
  return wall - stiffness * offset_;
}

double LoopLaw::step(double position, double stiffness, double period_s) {
  if (!started_)
    last_position_ = position, started_ = true;
  const double wall = wall_effort(wall_, stiffness, knee_, position);
  double effort = coupled(wall, stiffness, period_s);
  if (controller_.injected_damping > 0.0) {
    const double damping = controller_.injected_damping * velocity(position, period_s);
    if (!only_in_contact_ || wall_ == WallLaw::kBilateral) {
      effort += damping;
    } else if (wall > 0.0) {
      const double most = damping_fraction_ > 0.0
                              ? damping_fraction_ * std::abs(effort) + damping_free_
                              : std::numeric_limits<double>::infinity();
      effort = std::max(0.0, effort + std::min(damping, most));
    }
  }
  saturated_ = std::abs(effort) > max_effort_;
  return -std::clamp(effort, -max_effort_, max_effort_);
}

}  // namespace voxtouch::coupling_models
