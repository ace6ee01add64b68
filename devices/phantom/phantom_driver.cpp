#include "devices/phantom/phantom_driver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "devices/limits.hpp"

namespace voxtouch::phantom {
namespace {

using namespace std::chrono_literals;

// Times without a tick:
constexpr int kErrorCheckPeriods = 2;  // after this, `read` polls the library's errors
constexpr int kStallPeriods = 5;       // after this, force output is turned off
constexpr auto kFirstTick = 1s;        // at the opening; after this, it fails
constexpr auto kLongSilence = 200ms;   // after this, `last_error` reports it

}  // namespace

PhantomDriver::PhantomDriver(const PhantomOptions& options)
    : options_(options),
      library_(HdLibrary::load(options.library)) {
  session_.emplace(library_, options_);
  virtual_time_ = session_->virtual_time();
  description_ = describe_phantom(session_->facts());
  is_known_arm_ = session_->facts().model.starts_with("PHANTOM Premium 1.5") &&
                  session_->facts().input_dof >= 6;
  servo_.emplace(library_, session_->device(), session_->facts(), description_,
                 options_.velocity_cutoff_hz, virtual_time_);
  session_->start(&PhantomServo::run, &*servo_);
  description_ = describe_phantom(session_->facts());  // the rate is now available
  servo_->set_rate(description_.rate_hz);
  period_ = std::chrono::nanoseconds(std::llround(1e9 / description_.rate_hz));
  if (!virtual_time_)
    wait_for_first_tick();
  sample_.sample.pose_valid = false;
}

PhantomDriver::~PhantomDriver() { stop(); }

void PhantomDriver::wait_for_first_tick() {
  if (!servo_->take(sample_, Clock::now() + kFirstTick))
    throw devices::DeviceOpenError(
        "device 'phantom': its servo loop does not tick. End other programs that use the device, "
        "and check cable and the vendor's diagnostic tool");
  if (const hd::HDerror fatal = servo_->errors().fatal(); fatal != hd::kSuccess)
    throw devices::DeviceOpenError(
        fmt::format("device 'phantom': error {} in its first tick. Check cable and power",
                    error_text(library_.api(), fatal)));
}

/// The permanent error that has ended the session; empty while it runs.
std::optional<devices::DeviceError> PhantomDriver::fatal_error() const noexcept {
  const hd::HDerror fatal = servo_->errors().fatal();
  if (fatal == hd::kSuccess)
    return {};
  return classify(fatal).error;
}

devices::DeviceResult<devices::DeviceSample> PhantomDriver::read(
    std::chrono::microseconds timeout) noexcept {
  if (const auto error = fatal_error())
    return std::unexpected(*error);
  const bool ticked = virtual_time_ ? make_ticks(timeout) : wait_for_tick(timeout);
  if (const auto error = fatal_error()) {
    servo_->drop();
    if (!ticked)
      servo_->force_off();  // no tick will set zero force
    return std::unexpected(*error);
  }
  if (!ticked)
    return std::unexpected(missing_tick());
  if (std::exchange(first_, false))
    zero_ns_ = sample_.sample.time_ns;
  sample_.sample.time_ns -= zero_ns_;
  if (const Pose& pose = sample_.sample.pose; is_known_arm_ && sample_.sample.pose_valid)
    if (const auto angles = phantom_chain({}, pose.position, pose.orientation))
      joints_ = *angles;
  sample_.sample.pose.position += options_.origin_in_d;
  pose_lost_.store(!sample_.sample.pose_valid, std::memory_order_relaxed);
  return sample_.sample;
}

/// Real time: waits for a sample of the servo thread. While a tick is overdue, reads the library's
/// errors, since the servo thread, which otherwise does, may have stopped.
bool PhantomDriver::wait_for_tick(std::chrono::microseconds timeout) noexcept {
  const Clock::time_point deadline = Clock::now() + timeout;
  for (;;) {
    const Clock::time_point until = std::min(deadline, Clock::now() + kErrorCheckPeriods * period_);
    if (servo_->take(sample_, until))
      return true;
    servo_->errors().drain(library_.api());
    if (fatal_error() || Clock::now() >= deadline)
      return false;
  }
}

/// Virtual time: makes ticks until one has a sample; as many as fit into `timeout`, at least one.
bool PhantomDriver::make_ticks(std::chrono::microseconds timeout) noexcept {
  const auto most = std::max<std::int64_t>(1, std::chrono::nanoseconds(timeout) / period_);
  for (std::int64_t i = 0; i < most; ++i) {
    const int result = library_.hooks().step();
    if (servo_->take(sample_, Clock::time_point{}))
      return true;
    servo_->errors().drain(library_.api());
    if (result < 0)
      servo_->errors().note(hd::kTimerError);  // the servo loop has stopped
    if (fatal_error())
      return false;
  }
  return false;
}

/// The error of a `read` without a tick. Turns force output off if the servo loop has stalled.
devices::DeviceError PhantomDriver::missing_tick() noexcept {
  const Clock::duration silence = servo_->silence();
  if (virtual_time_ || silence > kStallPeriods * period_)
    servo_->force_off();
  const bool gone =
      !virtual_time_ && std::chrono::duration<double>(silence).count() > options_.silence_s;
  return gone ? devices::DeviceError::kDisconnected : devices::DeviceError::kTimeout;
}

devices::DeviceResult<void> PhantomDriver::write(const Wrench& command) noexcept {
  if (const auto error = fatal_error())
    return servo_->drop(), std::unexpected(*error);
  if (const auto good = devices::check_command(command, description_); !good)
    return servo_->drop(), good;
  const std::uint64_t errors = servo_->errors().count();
  if (known_errors_.exchange(errors, std::memory_order_relaxed) != errors) {
    servo_->drop();
    return std::unexpected(classify(servo_->errors().newest()).error);
  }
  if (!sample_.sample.pose_valid)
    return servo_->drop(), std::unexpected(devices::DeviceError::kProtocol);
  servo_->set_command(command, errors);
  return {};
}

void PhantomDriver::stop() noexcept {
  if (!servo_)
    return;
  servo_->drop();
  if (!virtual_time_ && servo_->silence() > kStallPeriods * period_)
    servo_->force_off();
}

/// Any thread: reads only atomic or constant values.
std::string PhantomDriver::last_error() const {
  const HdErrorLog& last_error = servo_->errors();
  if (const hd::HDerror fatal = last_error.fatal(); fatal != hd::kSuccess) {
    const bool gone = classify(fatal).error == devices::DeviceError::kDisconnected;
    return fmt::format("ended by error {}; {}, and open it again",
                       error_text(library_.api(), fatal),
                       gone ? "check cable and power" : "check the device and restart it");
  }
  const Clock::duration silence = servo_->silence();
  if (!virtual_time_ && silence > kLongSilence)
    return fmt::format(
        "its servo loop has not ticked for {:.1f} s. Check the device and the vendor's diagnostic "
        "tool, and open it again",
        std::chrono::duration<double>(silence).count());
  if (last_error.count() != known_errors_.load(std::memory_order_relaxed))
    return fmt::format("force dropped by error {}; it returns with the next commands",
                       error_text(library_.api(), last_error.newest()));
  if (pose_lost_.load(std::memory_order_relaxed))
    return "no force: its pose is invalid. Check encoders and cable";
  return {};
}

}  // namespace voxtouch::phantom
