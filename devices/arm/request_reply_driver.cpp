#include "devices/arm/request_reply_driver.hpp"

#include <algorithm>

#include "devices/limits.hpp"

namespace voxtouch::arm {

devices::DeviceResult<devices::DeviceSample> RequestReplyDriver::read(
    std::chrono::microseconds timeout) noexcept {
  if (!fresh_) {
    if (unanswered_)
      ++counts_.unread_answers, reply_without_force();
    const std::uint64_t malformed = counts_.malformed;
    const std::chrono::duration<double> patience(virtual_time_ ? virtual_timeout_s_ : 0.0);
    const auto wait =
        std::max<Clock::duration>(std::chrono::duration_cast<Clock::duration>(patience), timeout);
    switch (wait_and_take(Clock::now() + wait)) {
      case Intake::kNothing:
        return std::unexpected(nothing_new(malformed));
      case Intake::kInvalid:
        return std::unexpected(devices::DeviceError::kProtocol);  // already answered
      case Intake::kNew:
        accept();
    }
  }
  fresh_ = false;
  const devices::DeviceError last_error = closed() ? devices::DeviceError::kDisconnected : error();
  if (last_error == devices::DeviceError::kRecoverable)
    return sample_;
  reply_without_force();
  return std::unexpected(last_error);
}

devices::DeviceResult<void> RequestReplyDriver::write(const Wrench& command) noexcept {
  if (!unanswered_)
    return std::unexpected(devices::DeviceError::kTimeout);
  if (const auto good = devices::check_command(command, description_); !good) {
    ++counts_.refused;
    reply_without_force();
    return good;
  }
  const bool allowed = force_allowed();
  if (!allowed || !sample_.pose_valid) {
    reply_without_force();
    return std::unexpected(allowed ? devices::DeviceError::kProtocol : error());
  }
  if (!reply_with(command))
    return std::unexpected(devices::DeviceError::kRecoverable);
  return {};
}

RequestReplyDriver::Intake RequestReplyDriver::wait_and_take(Clock::time_point deadline) noexcept {
  for (;;) {
    if (const Intake intake = take(); intake != Intake::kNothing)
      return intake;
    const auto left = deadline - Clock::now();
    if (left <= Clock::duration::zero() || !socket_->wait(left))
      return Intake::kNothing;
  }
}

RequestReplyDriver::Intake RequestReplyDriver::take() noexcept {
  Intake newest = Intake::kNothing;
  while (const auto datagram = socket_->receive(buffer_)) {
    const Intake intake =
        classify(*datagram, std::span(buffer_).first(std::min(datagram->size, buffer_.size())));
    if (intake == Intake::kNothing)
      continue;
    if (newest != Intake::kNothing)
      ++counts_.superseded;
    newest = intake;
    controller_ = datagram->from;
    keep(intake);
  }
  if (newest == Intake::kInvalid)
    reply_to_invalid();
  return newest;
}

devices::DeviceError RequestReplyDriver::nothing_new(std::uint64_t malformed_before) noexcept {
  silent_.store(true, std::memory_order_relaxed);
  const bool lost =
      std::chrono::duration<double>(Clock::now() - received_.load(std::memory_order_relaxed))
          .count() > silence_s_;
  received_nothing(lost);
  if (lost || closed())
    return devices::DeviceError::kDisconnected;
  return counts_.malformed != malformed_before ? devices::DeviceError::kProtocol
                                               : devices::DeviceError::kTimeout;
}

}  // namespace voxtouch::arm
