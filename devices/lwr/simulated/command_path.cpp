#include "devices/lwr/simulated/command_path.hpp"

#include <algorithm>

namespace voxtouch::lwr_sim {
CommandPath::CommandPath(int ticks_per_period) noexcept : ticks_(std::max(ticks_per_period, 1)) {}

void CommandPath::start(const Setpoint& start) noexcept {
  from_ = to_ = start;
  done_ = ticks_;
  misses_ = 0;
  position_step_.setZero();
}

void CommandPath::begin(const Setpoint& requested) noexcept {
  from_ = to_;  // every period ends at its goal
  to_ = requested;
  done_ = 0;
}

void CommandPath::answer(const Setpoint& requested) noexcept {
  begin(requested);
  misses_ = 0;
  position_step_ = to_.position - from_.position;
}

void CommandPath::miss() noexcept {
  Setpoint requested = to_;
  if (++misses_ <= kExtrapolated)
    requested.position += position_step_;
  begin(requested);
}

Setpoint CommandPath::tick() noexcept {
  done_ = std::min(done_ + 1, ticks_);
  const double fraction = static_cast<double>(done_) / ticks_;
  Setpoint now = to_;
  if (done_ < ticks_) {
    now.position = from_.position + fraction * (to_.position - from_.position);
    now.torque = from_.torque + fraction * (to_.torque - from_.torque);
  }
  return now;
}

}  // namespace voxtouch::lwr_sim
