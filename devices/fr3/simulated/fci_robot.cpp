#include "devices/fr3/simulated/fci_robot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

namespace voxtouch::fr3_sim {
namespace {

using fr3::fci::ControllerMode;
using fr3::fci::Errors;
using fr3::fci::Outcome;
using fr3::fci::Request;
using fr3::fci::RobotMode;

constexpr Errors bit(std::size_t error) { return Errors{1} << error; }
constexpr Errors kJointLimit = bit(0), kJointSpeed = bit(3), kCartesianReflex = bit(7);

const RobotConfig& checked(const RobotConfig& config) {
  config.validate();
  return config;
}

}  // namespace

void RobotConfig::validate() const {
  ArmConfig::validate();
  arm_sim::require(fr3::fci::dialect_of(version) != nullptr, "version", "one of 3 to 10");
}

FciRobot::FciRobot(const RobotConfig& config, hand::Hand hand, FaultSchedule faults)
    : SimulatedArm(checked(config), std::move(hand), std::move(faults)),
      config_(config),
      dialect_(fr3::fci::dialect_of(config.version)),
      held_rad_(config.start_rad) {}

const fr3::fci::State& FciRobot::measure() noexcept {
  watch_people();
  pending_.reset();
  not_finite_ = false;
  fr3::fci::State& s = state_;
  s.message_id = ticks_ + 1;
  s.q = measured_rad();
  s.dq = plant_.rate();
  s.tau = plant_.sensed_torque();
  s.tau_d = commanded_;
  const fr3::Fr3Arm::State pose = fr3::Fr3Arm(Pose{config_.ee_in_flange, Quat::Identity()}).at(s.q);
  s.ee_in_base = pose.pose_BT.position;
  s.ee_in_flange = config_.ee_in_flange;
  s.success_rate =
      in_motion() ? 0.01 * static_cast<double>(std::count(window_.begin(), window_.end(), true))
                  : 0.0;
  if (const auto joint = faults_.active(FaultKind::kNan, time_s()))
    s.q[static_cast<Eigen::Index>(*joint) - 1] = std::numeric_limits<double>::quiet_NaN();
  return s;
}

void FciRobot::receive(std::span<const std::byte> datagram) noexcept {
  fr3::fci::Command command;
  const fr3::fci::PacketFault fault = fr3::fci::decode(*dialect_, datagram, command);
  if (fault == fr3::fci::PacketFault::kLength) {
    ++counts_.length;
    return;
  }
  if (!in_motion()) {
    ++counts_.idle;
    return;
  }
  if (command.message_id != state_.message_id) {
    ++counts_.stale;
    return;
  }
  if (fault != fr3::fci::PacketFault::kNone)
    ++counts_.not_finite, not_finite_ = true;
  pending_ = command;
}

Outcome FciRobot::request(Request request, const fr3::fci::Received& body) noexcept {
  switch (request) {
    case Request::kConnect:
      return Outcome::kSuccess;
    case Request::kSetCollisionBehavior: {
      if (in_motion())
        return Outcome::kNotPossible;
      // Upper, nominal, along x.
      std::memcpy(&worst_hand_n_, &body.body[(4 * 7 + 3 * 6) * 8], sizeof worst_hand_n_);
      return Outcome::kSuccess;
    }
    case Request::kSetLoad:
      return in_motion() ? Outcome::kNotPossible : Outcome::kSuccess;
    case Request::kErrorRecovery:
      if (state_.mode != RobotMode::kReflex)
        return state_.mode == RobotMode::kIdle ? Outcome::kSuccess : Outcome::kNotPossible;
      state_.mode = RobotMode::kIdle;
      state_.errors = 0;
      return Outcome::kSuccess;
    case Request::kStopMove:
      if (in_motion())
        leave(RobotMode::kIdle, Outcome::kPreempted);
      return Outcome::kSuccess;
    case Request::kMove: {
      if (state_.mode == RobotMode::kUserStopped)
        return Outcome::kEmergency;
      if (state_.mode != RobotMode::kIdle)
        return Outcome::kNotPossible;
      std::uint32_t controller = 0, generator = 0;
      std::memcpy(&controller, &body.body[0], sizeof controller);
      std::memcpy(&generator, &body.body[4], sizeof generator);
      if (controller != 2 || generator != dialect_->generator)
        return Outcome::kInvalidArgument;
      state_.mode = RobotMode::kMove;
      state_.controller = ControllerMode::kExternal;
      state_.generator_mode = dialect_->generator_mode;
      state_.reflex = 0;
      commanded_.setZero();
      drop_torque();
      window_.fill(false);
      consecutive_losses_ = 0;
      armed_ = false;
      hand_holds_ = true;
      ++counts_.motions;
      return Outcome::kStarted;
    }
  }
  return Outcome::kUnknown;
}

std::optional<Outcome> FciRobot::motion_ended() noexcept {
  return std::exchange(ended_, std::nullopt);
}

void FciRobot::abandoned() noexcept {
  if (in_motion())
    leave(RobotMode::kIdle, Outcome::kAborted);
  ended_.reset();
}

void FciRobot::leave(RobotMode to, Outcome how) noexcept {
  if (in_motion())
    ended_ = how;
  state_.mode = to;
  state_.controller = ControllerMode::kOther;
  state_.generator_mode = 0;
  held_rad_ = plant_.q();
  commanded_.setZero();
  drop_torque();
}

void FciRobot::reflex(Errors errors) noexcept {
  ++counts_.reflexes;
  state_.errors = state_.reflex = errors;
  leave(RobotMode::kReflex, Outcome::kReflex);
}

void FciRobot::watch_people() noexcept {
  const double now = time_s();
  const auto held = [&](FaultKind kind, RobotMode mode) {
    if (faults_.active(kind, now)) {
      if (state_.mode != mode)
        leave(mode, Outcome::kEmergency);
    } else if (state_.mode == mode) {
      leave(RobotMode::kIdle, Outcome::kAborted);
    }
  };
  held(FaultKind::kUserStop, RobotMode::kUserStopped);
  held(FaultKind::kGuiding, RobotMode::kGuiding);
  held(FaultKind::kNotReady, RobotMode::kOther);
  const auto error = faults_.active(FaultKind::kReflex, now);
  if (error && !reflex_done_)
    reflex(bit(static_cast<std::size_t>(*error)));
  reflex_done_ = error.has_value();
}

void FciRobot::take_command() noexcept {
  if (!in_motion())
    return;
  window_[ticks_ % window_.size()] = pending_.has_value();
  if (!pending_) {
    if (!armed_)
      return;
    ++counts_.missed;
    if (++consecutive_losses_ >= config_.limits.consecutive_losses)
      reflex(fr3::fci::kLostPacketsError);
    return;
  }
  armed_ = true;
  consecutive_losses_ = 0;
  ++counts_.commands;
  if (pending_->finished)
    return leave(RobotMode::kIdle, Outcome::kSuccess);
  if (not_finite_)
    return reflex(fr3::fci::kTorqueJumpError);
  const arm::Joints torque = pending_->torque_nm;
  if ((torque.array().abs() > config_.limits.torque_nm.array()).any())
    return reflex(fr3::fci::kTorqueRangeError);
  if ((torque - commanded_).cwiseAbs().maxCoeff() > config_.limits.torque_step_nm)
    return reflex(fr3::fci::kTorqueJumpError);
  commanded_ = torque;
}

void FciRobot::judge_motion() noexcept {
  if (!in_motion())
    return;
  if ((plant_.rate().array().abs() > config_.limits.speed_rad_s.array()).any())
    return reflex(kJointSpeed);
  if (plant_.at_stop())
    return reflex(kJointLimit);
  if (plant_.hand_wrench().force.norm() > worst_hand_n_)
    reflex(kCartesianReflex);
}

void FciRobot::tick() noexcept {
  const bool braked = state_.mode == RobotMode::kUserStopped || state_.mode == RobotMode::kOther;
  SimulatedArm::tick(
      commanded_, in_motion(), braked, [this](const arm::Joints& torque) -> arm::Joints {
        if (!in_motion())
          return arm_sim::position_law(config_.laws, plant_.terms(), plant_.q(), plant_.rate(),
                                       held_rad_);
        return config_.laws.compensates_coriolis ? arm::Joints(torque + plant_.terms().coriolis)
                                                 : torque;
      });
  measured_ = in_motion() ? torque_ : arm::Joints(arm::Joints::Zero());
}

void FciRobot::advance() noexcept {
  tick();
  take_command();
  judge_motion();
  ++ticks_;
}

Wrench FciRobot::applied() const noexcept {
  return measured_.isZero(0.0) ? Wrench{} : arm_sim::tool_wrench(plant_.terms(), measured_);
}

}  // namespace voxtouch::fr3_sim
