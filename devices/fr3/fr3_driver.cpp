#include "devices/fr3/fr3_driver.hpp"

#include <algorithm>

namespace voxtouch::fr3 {
namespace {

constexpr double kBeyondLimitRad = 0.05;  // the arm's stops are within this of its limits
// A larger jump, beyond the lifetime of a session, is not a count of milliseconds.
constexpr std::uint64_t kStrangeAhead = 5000;

}  // namespace

/// A sent reply cannot be withdrawn: the next one, with the next state, is a step closer to zero.
void Fr3Driver::stop() noexcept {
  if (unanswered_)
    reply_without_force();
}

// --- input

Fr3Driver::Intake Fr3Driver::classify(const arm::UdpSocket::Datagram& datagram,
                                      std::span<const std::byte> bytes) noexcept {
  if (datagram.from.address != link_->robot().address)
    return ++counts_.foreign, Intake::kNothing;
  const fci::PacketFault fault = fci::decode(*dialect_, bytes, incoming_);
  if (fault == fci::PacketFault::kLength)
    return ++counts_.malformed, Intake::kNothing;
  const std::uint64_t id = incoming_.message_id;
  if (started_ && id <= newest_id_)
    return ++counts_.out_of_order, Intake::kNothing;
  if (started_ && id - newest_id_ > kStrangeAhead)
    return ++counts_.from_future, Intake::kNothing;
  received_.store(Clock::now(), std::memory_order_relaxed);
  if (started_)
    counts_.lost += id - newest_id_ - 1, steps_ms_ += id - newest_id_;
  newest_id_ = id;
  const bool too_old = std::chrono::duration<double>(datagram.age).count() > options_.max_age_s;
  if (too_old && started_ && !virtual_time_)
    return ++counts_.stale, Intake::kNothing;
  if (fault != fci::PacketFault::kNone)
    return ++counts_.invalid, Intake::kInvalid;
  return Intake::kNew;
}

void Fr3Driver::received_nothing(bool) noexcept {
  receive_channel();
  noted_closed_.store(link_->closed(), std::memory_order_relaxed);
}

void Fr3Driver::accept() noexcept {
  const double elapsed_s = 1e-3 * static_cast<double>(steps_ms_);
  steps_ms_ = 0;
  unanswered_ = true;
  sample_.time_ns = static_cast<std::int64_t>(state_.message_id - first_id_) * 1'000'000;
  receive_channel();
  measure();
  const bool fast =
      sample_.pose_valid && (state_.dq.array().abs() > limits_.velocity_rad_s.array()).any();
  session_.update(state_, elapsed_s, fast);
  if (session_.listens())
    ramp_.acknowledge(state_.tau_d);
  else
    ramp_.forget();  // it has ended the motion and holds the arm itself
  ask_what_is_due();
  note();
  silent_.store(false, std::memory_order_relaxed);
}

/// Computes pose and twist in D. A state without usable angles keeps the previous pose, marked as
/// invalid and at rest.
void Fr3Driver::measure() noexcept {
  sample_.pose_valid = (state_.q.array() >= limits_.lowest_rad.array() - kBeyondLimitRad).all() &&
                       (state_.q.array() <= limits_.highest_rad.array() + kBeyondLimitRad).all() &&
                       (state_.dq.array().abs() < 100.0).all();
  if (!sample_.pose_valid) {
    ++counts_.invalid_poses;
    sample_.twist = {};
    return;
  }
  posture_ = arm_.at(state_.q);
  const Vec6 twist = posture_.jacobian * state_.dq;
  sample_.pose = options_.pose_BD.inverse() * posture_.pose_BT;
  sample_.pose.orientation.normalize();
  sample_.twist = {rotation_DB_ * twist.head<3>(), rotation_DB_ * twist.tail<3>()};
}

// --- the command channel

void Fr3Driver::receive_channel() noexcept {
  while (const auto received = link_->poll())
    receive(*received);
}

void Fr3Driver::receive(const fci::Received& received) noexcept {
  const auto request = fci::request_of(*dialect_, received.command);
  if (!request)
    return;
  // The reply to an ended motion may arrive after the start of the next.
  if (*request == fci::Request::kMove && received.id != move_request_)
    return;
  session_.answered(*request, fci::outcome_of(*dialect_, *request, received));
}

void Fr3Driver::ask_what_is_due() noexcept {
  const auto request = session_.due();
  if (!request)
    return;
  const std::uint32_t id = next_request_++;
  if (*request == fci::Request::kMove) {
    move_request_ = id;
    link_->send(fci::move_request(*dialect_, id));
  } else {
    link_->send(fci::bare_request(*dialect_, *request, id));
  }
  // The two channels have no common order. If runs must be reproducible, one is read completely and
  // then the other.
  while (virtual_time_) {
    const auto received = link_->wait(options_.virtual_timeout_s);
    if (!received)
      return;
    receive(*received);
    if (received->id == id)
      return;
  }
}

// --- output

bool Fr3Driver::reply_with(const Wrench& command) noexcept {
  const Quat rotation_BD = rotation_DB_.conjugate();
  const Wrench requested =
      within_joints({rotation_BD * command.force, rotation_BD * command.torque});
  posture_ratio_ = options_.posture.ramp_s > 0.0
                       ? std::min(1.0, posture_ratio_ + 1e-3 / options_.posture.ramp_s)
                       : 1.0;
  const Joints posture = posture_ratio_ * arm::posture_torque(options_.posture, posture_.jacobian,
                                                              state_.q, state_.dq);
  return send(ramp_.next(posture_.jacobian, requested, posture));
}

/// Scales the wrench down, with constant direction, if a joint would exceed its torque limit.
Wrench Fr3Driver::within_joints(Wrench command) noexcept {
  const Joints torque = arm::joint_torque(posture_.jacobian, command);
  const double need =
      (torque.array().abs() / options_.max_add_torque_nm.array().max(1e-9)).maxCoeff();
  if (need <= 1.0)
    return command;
  ++counts_.scaled;
  return {command.force / need, command.torque / need};
}

void Fr3Driver::reply_without_force() noexcept {
  posture_ratio_ = 0.0;
  send(ramp_.next(posture_.jacobian, {}, Joints::Zero()));
}

/// Replies to a state without a pose: the next step towards zero, at the last valid posture.
void Fr3Driver::reply_to_invalid() noexcept {
  if (!started_)
    return;
  state_.message_id = newest_id_;
  ramp_.acknowledge(incoming_.tau_d);
  reply_without_force();
  noted_usable_.store(false, std::memory_order_relaxed);
}

bool Fr3Driver::send(const Joints& torque) noexcept {
  unanswered_ = false;
  if (!session_.listens() && !virtual_time_)
    return true;  // the robot accepts commands only during a motion
  std::array<std::byte, fci::kMaxCommandBytes> bytes;
  const std::size_t size =
      fci::encode(*dialect_, {state_.message_id, torque, ending_ && ramp_.at_rest()}, bytes);
  if (socket_->send(std::span(bytes).first(size), controller_))
    return ++counts_.answered, true;
  ++counts_.send_errors;
  return false;
}

}  // namespace voxtouch::fr3
