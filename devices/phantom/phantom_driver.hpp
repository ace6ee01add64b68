#pragma once
/// Driver for a SensAble / 3D Systems Phantom (Premium, Desktop, Omni, Touch). It uses the vendor's
/// HDAPI or the simulated library.
#include <array>
#include <atomic>
#include <chrono>
#include <optional>
#include <span>
#include <string>

#include "devices/driver.hpp"
#include "devices/phantom/hd_session.hpp"
#include "devices/phantom/phantom_arm.hpp"
#include "devices/phantom/phantom_options.hpp"
#include "devices/phantom/phantom_servo.hpp"

namespace voxtouch::phantom {

/// One thread owns the driver. The vendor's servo thread calls PhantomServo once per period, which
/// is a tick: it stores a sample and sets the force of the last command. `read` waits for a tick;
/// neither thread waits for a lock of the other.
///
/// Errors of `read`:
///   kTimeout: no tick in time. After five periods, force output is off until the next command.
///   kDisconnected: communication lost, or no tick for `silence_s`. Permanent: reopen the device.
///   kFault: device fault, timer, scheduler or unknown error. Permanent: reopen the device.
/// Errors of `write`, while samples continue:
///   kNotFinite, kLimit: see check_command.
///   kRecoverable: force dropped: motors too warm, moved too fast, force or its change too large.
///   kProtocol: a refused call, an invalid pose in the sample, or no sample yet.
/// After an error no command gives force until a `write` has reported it. The next one is accepted.
///
/// A tick with an error or an invalid pose sets no force, so the motors are at zero within one
/// period. If the servo loop has stopped, `read` detects an error after two periods and a stall
/// after five, and turns force output off. Until then only the amplifier's watchdog can do so.
///
/// The orientation is that of the stylus including the gimbal, orthonormalised. The twist has the
/// lag of TwistEstimate. ThermalClamp reduces the force while motors are warm.
///
/// Time is that of the monotonic clock since the first sample. In virtual time, which only the
/// simulated library supports, `read` makes the ticks and `simulated()` is true. The first command
/// acts in the second tick, as in real time, and equal calls give bit-identical results.
class PhantomDriver : public devices::Driver {
 public:
  /// Throws DeviceOpenError, with a remedy, if library, device, calibration or servo loop fails. If
  /// it sets encoders to zero (EncoderReset), all links must be held at right angles.
  explicit PhantomDriver(const PhantomOptions& options);
  /// Sets zero force, stops the servo loop, removes the callback and disables the device.
  ~PhantomDriver() override;

  const DeviceDescription& description() const noexcept override { return description_; }
  devices::DeviceResult<devices::DeviceSample> read(
      std::chrono::microseconds timeout) noexcept override;
  devices::DeviceResult<void> write(const Wrench& command) noexcept override;
  void stop() noexcept override;
  bool simulated() const noexcept override { return virtual_time_; }
  std::string last_error() const override;
  std::string_view serial() const noexcept override { return session_->facts().serial; }
  /// For a Premium 1.5 with a gimbal that reports its angles. The pose gives the joints: to read
  /// them would need another call in each tick, and a refused call drops the force.
  const arm::ArmDescription* arm_description() const noexcept override {
    return is_known_arm_ ? &phantom_description() : nullptr;
  }
  std::span<const double> joints() const noexcept override { return joints_; }

  /// For the owning thread: counts and errors, the last sample with its thermal force limit, and
  /// the properties of the device. Real-time safe.
  const PhantomServo& servo() const noexcept { return *servo_; }
  const ServoSample& sample() const noexcept { return sample_; }
  const PhantomFacts& facts() const noexcept { return session_->facts(); }

 private:
  using Clock = PhantomServo::Clock;
  std::optional<devices::DeviceError> fatal_error() const noexcept;
  bool wait_for_tick(std::chrono::microseconds timeout) noexcept;
  bool make_ticks(std::chrono::microseconds timeout) noexcept;
  devices::DeviceError missing_tick() noexcept;
  void wait_for_first_tick();

  PhantomOptions options_;
  const HdLibrary& library_;
  DeviceDescription description_;
  std::optional<PhantomServo> servo_;
  std::optional<HdSession> session_;  // declared after the servo: destroyed first, together with
                                      // the callback
  Clock::duration period_{};
  ServoSample sample_;
  std::int64_t zero_ns_ = 0;                    // time of the first sample, monotonic clock
  std::atomic<std::uint64_t> known_errors_{0};  // errors already reported to the caller
  std::atomic<bool> pose_lost_{false};          // of the last sample
  bool first_ = true, virtual_time_ = false, is_known_arm_ = false;
  std::array<double, kChainJoints>
      joints_{};  // the last valid ones, if the arm does not reach the reported pose
};

}  // namespace voxtouch::phantom
