#include "devices/lwr/lwr_driver.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>

#include "devices/limits.hpp"

namespace voxtouch::lwr {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kGapPeriods = 5;  // after a longer gap a difference of positions says nothing about now
constexpr double kBeyondLimitRad = 0.05;  // the arm's own stops are within this of its limits

std::int64_t wall_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

std::span<const std::byte> bytes_of(const fri::CmdPacket& packet) noexcept {
  return std::as_bytes(std::span<const fri::CmdPacket, 1>(&packet, 1));
}

}  // namespace

devices::DeviceResult<devices::DeviceSample> LwrDriver::read(std::chrono::microseconds timeout) noexcept {
  if (!fresh_) {
    if (unanswered_) ++counts_.unread_answers, answer_without_push();
    const std::uint64_t malformed = counts_.malformed;
    const std::chrono::duration<double> patience(virtual_time_ ? options_.virtual_timeout_s : 0.0);
    const auto wait = std::max<Clock::duration>(std::chrono::duration_cast<Clock::duration>(patience), timeout);
    switch (wait_and_take(Clock::now() + wait)) {
      case Intake::kNothing: return std::unexpected(nothing_new(malformed));
      case Intake::kUntrusted: return std::unexpected(devices::DeviceError::kProtocol);  // already answered
      case Intake::kNew: accept();
    }
  }
  fresh_ = false;
  const devices::DeviceError error = session_.error();
  if (error == devices::DeviceError::kRecoverable) return sample_;
  answer_without_push();
  return std::unexpected(error);
}

devices::DeviceResult<void> LwrDriver::write(const Wrench& command) noexcept {
  if (!unanswered_) return std::unexpected(devices::DeviceError::kTimeout);
  if (const auto good = devices::check_command(command, description_); !good) {
    ++counts_.refused;
    answer_without_push();
    return good;
  }
  if (!session_.force_allowed() || !sample_.pose_valid) {
    const devices::DeviceError error = session_.force_allowed() ? devices::DeviceError::kProtocol : session_.error();
    answer_without_push();
    return std::unexpected(error);
  }
  const fri::CmdPacket& packet = composer_->answer(msr_, session_, true, push_for(command));
  pushing_ = true;
  if (!send(packet)) return std::unexpected(devices::DeviceError::kRecoverable);
  return {};
}

/// Outside virtual time an answer that has gone out already is taken back by a second one: the controller acts on the newest.
void LwrDriver::stop() noexcept {
  if (unanswered_ || (pushing_ && !virtual_time_)) answer_without_push();
}

// --- what comes in

LwrDriver::Intake LwrDriver::wait_and_take(Clock::time_point deadline) noexcept {
  for (;;) {
    if (const Intake intake = take(); intake != Intake::kNothing) return intake;
    const auto left = deadline - Clock::now();
    if (left <= 0ns || !socket_.wait(left)) return Intake::kNothing;
  }
}

/// Empties the socket; what counts is the newest measurement in it.
LwrDriver::Intake LwrDriver::take() noexcept {
  Intake newest = Intake::kNothing;
  while (const auto datagram = socket_.receive(buffer_)) {
    const Intake intake = judge(*datagram);
    if (intake == Intake::kNothing) continue;
    if (newest != Intake::kNothing) ++counts_.superseded;
    newest = intake;
    controller_ = datagram->from;
    msr_.header = incoming_.header;
    if (intake == Intake::kNew) msr_ = incoming_;
  }
  if (newest == Intake::kUntrusted && composer_ && composer_->ready()) {
    send(composer_->answer_untrusted(msr_.header, session_));
    pushing_ = unanswered_ = false;
    posture_share_ = 0.0;
    Noted noted = noted_now();
    noted.usable = false;
    noted_.store(noted, std::memory_order_relaxed);
  }
  return newest;
}

LwrDriver::Intake LwrDriver::judge(const UdpSocket::Datagram& datagram) noexcept {
  const std::span<const std::byte> bytes(buffer_.data(), std::min(datagram.size, buffer_.size()));
  capture_.note(bytes, datagram.from, socket_.local(), wall_ns());
  if (controller_.address != 0 && datagram.from.address != controller_.address)
    return ++counts_.foreign, Intake::kNothing;
  const fri::PacketFault fault = fri::decode(bytes, incoming_);
  const bool untrusted = fault == fri::PacketFault::kEnum || fault == fri::PacketFault::kNotFinite;
  if (fault != fri::PacketFault::kNone)
    last_fault_ = fault, last_bad_size_ = datagram.size, last_bad_from_ = datagram.from;
  if (fault != fri::PacketFault::kNone && !untrusted) return ++counts_.malformed, Intake::kNothing;
  heard_.store(Clock::now(), std::memory_order_relaxed);
  if (sequence_.see(incoming_.header.send_seq) != fri::SequenceTracker::Verdict::kNew) return Intake::kNothing;
  steps_ += sequence_.steps();
  const bool too_old = std::chrono::duration<double>(datagram.age).count() > options_.max_age_s;
  if (too_old && composer_ && !virtual_time_)  // before the first one nothing is known, virtual time not either
    return ++counts_.aged, Intake::kNothing;
  if (untrusted) return ++counts_.untrusted, Intake::kUntrusted;
  return Intake::kNew;
}

devices::DeviceError LwrDriver::nothing_new(std::uint64_t malformed_before) noexcept {
  ++counts_.timeouts;
  silent_.store(true, std::memory_order_relaxed);
  if (std::chrono::duration<double>(Clock::now() - heard_.load(std::memory_order_relaxed)).count() > options_.silence_s) {
    sequence_.forget();
    rates_.restart();
    return devices::DeviceError::kDisconnected;
  }
  return counts_.malformed != malformed_before ? devices::DeviceError::kProtocol : devices::DeviceError::kTimeout;
}

void LwrDriver::accept() noexcept {
  if (steps_ > kGapPeriods) rates_.restart();
  const double elapsed_s =
      1e-9 * static_cast<double>(clock_->see(msr_.interface.timestamp_s, std::max<std::uint64_t>(steps_, 1)));
  steps_ = 0;
  unanswered_ = true;
  sample_.time_ns = clock_->time_ns();
  measure(elapsed_s);
  session_.see(msr_, elapsed_s, sample_.pose_valid ? check_arm() : fri::Trouble::kNone);
  noted_.store(noted_now(), std::memory_order_relaxed);
  silent_.store(false, std::memory_order_relaxed);
}

/// Pose and twist in D. A measurement without usable joint positions leaves the pose as it was, marked, and at rest.
void LwrDriver::measure(double elapsed_s) noexcept {
  const LwrJoints q = fri::from_wire(msr_.data.jnt_pos);
  sample_.pose_valid =
      fri::measured_finite(msr_) && ((q.array().abs() <= limits_.position_rad.array() + kBeyondLimitRad)).all();
  if (!sample_.pose_valid) {
    ++counts_.invalid_poses;
    rates_.restart();
    sample_.twist = {};
    return;
  }
  q_ = q;
  posture_ = arm_.at(q);
  const Vec6 twist = posture_.jacobian * rates_.see(q, elapsed_s);
  sample_.pose = options_.pose_BD.inverse() * posture_.pose_BT;
  sample_.pose.orientation.normalize();
  sample_.twist = {rotation_DB_ * twist.head<3>(), rotation_DB_ * twist.tail<3>()};
}

fri::Trouble LwrDriver::check_arm() const noexcept {
  const bool fast = (rates_.rate().array().abs() > limits_.velocity_rad_s.array()).any();
  return fast ? fri::Trouble::kTooFast : fri::Trouble::kNone;
}

// --- what goes out

LwrJoints LwrDriver::push_for(const Wrench& command) noexcept {
  const Quat rotation_BD = rotation_DB_.conjugate();
  LwrJoints torque = joint_torque(posture_.jacobian, {rotation_BD * command.force, rotation_BD * command.torque});
  const double need = (torque.array().abs() / options_.max_add_torque_nm.array().max(1e-9)).maxCoeff();
  if (need > 1.0) ++counts_.scaled, torque /= need;
  const double step =
      options_.posture.ramp_s > 0.0 ? 1e-9 * static_cast<double>(period_ns_) / options_.posture.ramp_s : 1.0;
  posture_share_ = std::min(1.0, posture_share_ + step);
  torque += posture_share_ * posture_torque(options_.posture, posture_.jacobian, q_, rates_.rate());
  return torque.cwiseMax(-options_.max_add_torque_nm).cwiseMin(options_.max_add_torque_nm);
}

void LwrDriver::answer_without_push() noexcept {
  pushing_ = false;
  posture_share_ = 0.0;
  if (composer_) send(composer_->answer(msr_, session_, sample_.pose_valid, LwrJoints::Zero()));
}

bool LwrDriver::send(const fri::CmdPacket& packet) noexcept {
  unanswered_ = false;
  capture_.note(bytes_of(packet), socket_.local(), controller_, wall_ns());
  if (socket_.send(bytes_of(packet), controller_)) return ++counts_.answered, true;
  ++counts_.send_errors;
  return false;
}

}  // namespace voxtouch::lwr
