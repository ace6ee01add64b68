#include "devices/lwr/lwr_driver.hpp"

#include <algorithm>
#include <ctime>

namespace voxtouch::lwr {
namespace {

// After a longer gap a difference of positions is not the present velocity.
constexpr std::uint64_t kGapPeriods = 5;
constexpr double kBeyondLimitRad = 0.05;  // the arm's stops are within this of its limits

std::int64_t wall_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

std::span<const std::byte> bytes_of(const fri::CmdPacket& packet) noexcept {
  return std::as_bytes(std::span<const fri::CmdPacket, 1>(&packet, 1));
}

}  // namespace

/// Outside virtual time, a second reply replaces a reply already sent: the controller uses the
/// newest.
void LwrDriver::stop() noexcept {
  if (unanswered_ || (replied_with_force_ && !virtual_time_))
    reply_without_force();
}

// --- input

void LwrDriver::keep(Intake intake) noexcept {
  msr_.header = incoming_.header;
  if (intake == Intake::kNew)
    msr_ = incoming_;
}

void LwrDriver::reply_to_invalid() noexcept {
  if (!composer_ || !composer_->ready())
    return;
  send(composer_->reply_to_invalid(msr_.header, session_));
  replied_with_force_ = unanswered_ = false;
  posture_ratio_ = 0.0;
  Snapshot snapshot = take_snapshot();
  snapshot.usable = false;
  snapshot_.store(snapshot, std::memory_order_relaxed);
}

LwrDriver::Intake LwrDriver::classify(const UdpSocket::Datagram& datagram,
                                      std::span<const std::byte> bytes) noexcept {
  capture_.note(bytes, datagram.from, socket_->local(), wall_ns());
  if (controller_.address != 0 && datagram.from.address != controller_.address)
    return ++counts_.foreign, Intake::kNothing;
  const fri::PacketFault fault = fri::decode(bytes, incoming_);
  const bool invalid = fault == fri::PacketFault::kEnum || fault == fri::PacketFault::kNotFinite;
  if (fault != fri::PacketFault::kNone)
    last_fault_ = fault, last_bad_size_ = datagram.size, last_bad_from_ = datagram.from;
  if (fault != fri::PacketFault::kNone && !invalid)
    return ++counts_.malformed, Intake::kNothing;
  received_.store(Clock::now(), std::memory_order_relaxed);
  if (sequence_.update(incoming_.header.send_seq) != fri::SequenceTracker::Verdict::kNew)
    return Intake::kNothing;
  steps_ += sequence_.steps();
  const bool too_old = std::chrono::duration<double>(datagram.age).count() > options_.max_age_s;
  if (too_old && composer_ &&
      !virtual_time_)  // until the first one nothing is known, including virtual time
    return ++counts_.stale, Intake::kNothing;
  if (invalid)
    return ++counts_.invalid, Intake::kInvalid;
  return Intake::kNew;
}

void LwrDriver::received_nothing(bool lost) noexcept {
  if (!lost)
    return;
  sequence_.forget();
  rates_.restart();
}

void LwrDriver::accept() noexcept {
  if (steps_ > kGapPeriods)
    rates_.restart();
  const double elapsed_s =
      1e-9 * static_cast<double>(
                 clock_->update(msr_.interface.timestamp_s, std::max<std::uint64_t>(steps_, 1)));
  steps_ = 0;
  unanswered_ = true;
  sample_.time_ns = clock_->time_ns();
  measure(elapsed_s);
  session_.update(msr_, elapsed_s, sample_.pose_valid ? check_arm() : fri::Diagnostic::kNone);
  snapshot_.store(take_snapshot(), std::memory_order_relaxed);
  silent_.store(false, std::memory_order_relaxed);
}

/// Computes pose and twist in D. A measurement without usable joint positions keeps the previous
/// pose, marked as invalid and at rest.
void LwrDriver::measure(double elapsed_s) noexcept {
  const LwrJoints q = fri::from_wire(msr_.data.jnt_pos);
  sample_.pose_valid = fri::measured_finite(msr_) &&
                       ((q.array().abs() <= limits_.position_rad.array() + kBeyondLimitRad)).all();
  if (!sample_.pose_valid) {
    ++counts_.invalid_poses;
    rates_.restart();
    sample_.twist = {};
    return;
  }
  q_ = q;
  posture_ = arm_.at(q);
  const Vec6 twist = posture_.jacobian * rates_.update(q, elapsed_s);
  sample_.pose = options_.pose_BD.inverse() * posture_.pose_BT;
  sample_.pose.orientation.normalize();
  sample_.twist = {rotation_DB_ * twist.head<3>(), rotation_DB_ * twist.tail<3>()};
}

fri::Diagnostic LwrDriver::check_arm() const noexcept {
  const bool fast = (rates_.rate().array().abs() > limits_.velocity_rad_s.array()).any();
  return fast ? fri::Diagnostic::kTooFast : fri::Diagnostic::kNone;
}

// --- output

bool LwrDriver::reply_with(const Wrench& command) noexcept {
  const fri::CmdPacket& packet = composer_->answer(msr_, session_, true, added_torque(command));
  replied_with_force_ = true;
  return send(packet);
}

LwrJoints LwrDriver::added_torque(const Wrench& command) noexcept {
  const Quat rotation_BD = rotation_DB_.conjugate();
  LwrJoints torque =
      joint_torque(posture_.jacobian, {rotation_BD * command.force, rotation_BD * command.torque});
  const double need =
      (torque.array().abs() / options_.max_add_torque_nm.array().max(1e-9)).maxCoeff();
  if (need > 1.0)
    ++counts_.scaled, torque /= need;
  const double step = options_.posture.ramp_s > 0.0
                          ? 1e-9 * static_cast<double>(period_ns_) / options_.posture.ramp_s
                          : 1.0;
  posture_ratio_ = std::min(1.0, posture_ratio_ + step);
  torque += posture_ratio_ * posture_torque(options_.posture, posture_.jacobian, q_, rates_.rate());
  return torque.cwiseMax(-options_.max_add_torque_nm).cwiseMin(options_.max_add_torque_nm);
}

void LwrDriver::reply_without_force() noexcept {
  replied_with_force_ = false;
  posture_ratio_ = 0.0;
  if (composer_)
    send(composer_->answer(msr_, session_, sample_.pose_valid, LwrJoints::Zero()));
}

bool LwrDriver::send(const fri::CmdPacket& packet) noexcept {
  unanswered_ = false;
  capture_.note(bytes_of(packet), socket_->local(), controller_, wall_ns());
  if (socket_->send(bytes_of(packet), controller_))
    return ++counts_.answered, true;
  ++counts_.send_errors;
  return false;
}

}  // namespace voxtouch::lwr
