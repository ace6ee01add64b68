#include "devices/lwr/simulated/command_path.hpp"

#include <algorithm>

namespace voxtouch::lwr_sim {
namespace {

/// Normalised linear interpolation on the shorter way: no library function.
Quat between(const Quat& a, const Quat& b, double share) noexcept {
  const double sign = a.dot(b) < 0.0 ? -1.0 : 1.0;
  return Quat(Eigen::Vector4d((1.0 - share) * a.coeffs() + (share * sign) * b.coeffs())).normalized();
}

}  // namespace

CommandPath::CommandPath(int ticks_per_period, std::size_t delay_ticks) noexcept
    : ticks_(std::max(ticks_per_period, 1)), delay_(std::min(delay_ticks, kMaxDelay)) {}

void CommandPath::start(const Setpoint& held) noexcept {
  from_ = to_ = held;
  done_ = ticks_;
  misses_ = 0;
  position_step_.setZero();
  pose_step_.setZero();
  line_.fill({});
}

void CommandPath::begin(const Setpoint& wanted) noexcept {
  from_ = to_;  // every period ends at its goal
  to_ = wanted;
  done_ = 0;
}

void CommandPath::answer(const Setpoint& wanted) noexcept {
  begin(wanted);
  misses_ = 0;
  position_step_ = to_.position - from_.position;
  pose_step_ = to_.pose.position - from_.pose.position;
}

void CommandPath::miss() noexcept {
  Setpoint wanted = to_;
  if (++misses_ <= kExtrapolated) {
    wanted.position += position_step_;
    wanted.pose.position += pose_step_;
  }
  begin(wanted);
}

Setpoint CommandPath::tick() noexcept {
  done_ = std::min(done_ + 1, ticks_);
  const double share = static_cast<double>(done_) / ticks_;
  Setpoint now = to_;
  if (done_ < ticks_) {
    now.position = from_.position + share * (to_.position - from_.position);
    now.pose.position = from_.pose.position + share * (to_.pose.position - from_.pose.position);
    now.pose.orientation = between(from_.pose.orientation, to_.pose.orientation, share);
    now.torque = from_.torque + share * (to_.torque - from_.torque);
    now.wrench = from_.wrench + share * (to_.wrench - from_.wrench);
  }
  line_[next_] = {now.torque, now.wrench};
  const Force& out = line_[(next_ + line_.size() - delay_) % line_.size()];
  next_ = (next_ + 1) % line_.size();
  now.torque = out.torque;
  now.wrench = out.wrench;
  return now;
}

}  // namespace voxtouch::lwr_sim
