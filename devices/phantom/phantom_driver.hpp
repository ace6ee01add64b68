#pragma once
/// A SensAble / 3D Systems Phantom (Premium, Desktop, Omni, Touch) over the vendor's HDAPI, or the
/// simulated library in its place.
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

/// One thread owns it. The vendor's servo thread makes the samples and takes the commands
/// (PhantomServo); `read` waits for it, and neither ever waits for a lock of the other.
///
/// read: kTimeout (no tick in time; no tick for some periods turns force output off as well, until
/// the next command), kDisconnected (communication lost, or no tick for `silence_s`), kFault
/// (device fault, timer, scheduler, an unknown error). The last two stay where the library said so:
/// open the device anew. Errors that only cost force come from `write`, so that samples keep
/// coming. write: kNotFinite, kLimit (check_command), kRecoverable (the device dropped its force:
/// motors too warm, moved too fast, force or its change too large), kProtocol (the library refused
/// something, or the sample's pose was not valid; before the first sample as well). After an error
/// no command pushes until a `write` has reported it; the one after that is taken.
///
/// A tick that meets an error, or a pose that is not valid, sets no force, and the library makes
/// zero of that: the motors are at zero within one period. Where the servo loop itself has died
/// nothing can be set: `read` finds out after two periods and turns force output off; what an
/// amplifier does until then is its own matter, and its own watchdog's.
///
/// Orientation is the stylus's, gimbal included, made orthonormal. Twist is the driver's own, and
/// lags as TwistEstimate says. Force is clamped lower while motors are warm (ThermalClamp).
///
/// Time: from the first sample, by the monotonic clock. In virtual time, which only the simulated
/// library has, `read` makes its ticks and `simulated()` is true: the first command acts in the
/// second tick, as it would in reality, and the same calls give bit-identical results.
class PhantomDriver : public devices::Driver {
 public:
  /// Throws DeviceOpenError: library, device, calibration, servo loop; the sentence says what to
  /// do. A device whose encoders are set to zero has to be held with all links at right angles
  /// meanwhile.
  explicit PhantomDriver(const PhantomOptions& options);
  /// Zero force; servo loop stopped, callback taken out, device disabled.
  ~PhantomDriver() override;

  const DeviceDescription& description() const noexcept override { return description_; }
  devices::DeviceResult<devices::DeviceSample> read(
      std::chrono::microseconds timeout) noexcept override;
  devices::DeviceResult<void> write(const Wrench& command) noexcept override;
  void stop() noexcept override;
  bool simulated() const noexcept override { return virtual_time_; }
  std::string last_error() const override;
  std::string_view serial() const noexcept override { return session_->facts().serial; }
  /// Of a Premium 1.5 with a gimbal that reports its angles. Its joints are computed from tip and
  /// stylus: the library would be asked once more in each tick, and what it refuses to report would
  /// cost force.
  const arm::ArmDescription* arm_description() const noexcept override {
    return is_known_arm_ ? &phantom_description() : nullptr;
  }
  std::span<const double> joints() const noexcept override { return joints_; }

  /// For the thread that owns it: what ticks and errors there were, the last sample with what heat
  /// leaves of the force, and what the device reported of itself. Real-time safe.
  const PhantomServo& servo() const noexcept { return *servo_; }
  const ServoSample& sample() const noexcept { return sample_; }
  const PhantomFacts& facts() const noexcept { return session_->facts(); }

 private:
  using Clock = PhantomServo::Clock;
  std::optional<devices::DeviceError> ended() const noexcept;
  bool wait_for_tick(std::chrono::microseconds timeout) noexcept;
  bool make_ticks(std::chrono::microseconds timeout) noexcept;
  devices::DeviceError nothing_came() noexcept;
  void wait_for_first_tick();

  PhantomOptions options_;
  const HdLibrary& library_;
  DeviceDescription description_;
  std::optional<PhantomServo> servo_;
  std::optional<HdSession> session_;  // behind the servo: ends before it, and the callback with it
  Clock::duration period_{};
  ServoSample sample_;
  std::int64_t zero_ns_ = 0;
  std::atomic<std::uint64_t> known_errors_{0};  // errors that the caller knows of
  std::atomic<bool> pose_lost_{false};          // of the last sample
  bool first_ = true, virtual_time_ = false, is_known_arm_ = false;
  std::array<double, kChainJoints>
      joints_{};  // where the arm does not reach what the library reported, the last ones
};

}  // namespace voxtouch::phantom
