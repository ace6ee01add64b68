#pragma once
/// Interface of every haptic device, real or simulated.
#include <chrono>
#include <cstdint>
#include <expected>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/types/device_description.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::arm {
struct ArmDescription;
}

namespace voxtouch::devices {

/// Why a call in the loop failed. Kinds differ if the caller handles them differently.
enum class DeviceError : std::uint8_t {
  kTimeout,       ///< no sample within the time given; the device may still be there
  kDisconnected,  ///< device or controller unreachable
  kNotFinite,     ///< the command contains NaN or infinity; not sent
  kLimit,         ///< a command was over a limit; it was not sent
  kProtocol,      ///< the device violated its protocol
  kRecoverable,   ///< the device dropped its force (warm motors, too fast); commands work again
                  ///< later
  kFault,         ///< the device stopped and needs the operator
};
/// One word, for logs and messages. Real-time safe.
std::string_view name_of(DeviceError error) noexcept;

template <class T>
using DeviceResult = std::expected<T, DeviceError>;

/// A device could not be opened. The message has cause and remedy.
struct DeviceOpenError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One sample, in frame D, at the tool's origin.
struct DeviceSample {
  /// The device's clock, increasing; simulated time in a simulated device.
  std::int64_t time_ns = 0;
  Pose pose;                  ///< T in D
  Twist twist;                ///< D axes; filtered by the device, so it lags the pose
  std::uint32_t buttons = 0;  ///< bit 0 = first button
  bool pose_valid = true;     ///< false: the device marked the sample as invalid
};

/// An open device. It exists only while connected; destruction and every error path end in zero
/// force.
///
/// One thread owns a driver: `read`, then one `write`, once a period. `read`, `write` and `stop`
/// are real-time safe: no allocation, no lock that a slower thread holds, no log, no throw.
///
/// A real device sets the pace: `read` blocks until its next sample, so the caller does not sleep.
///
/// FRI: `read` waits for the next measurement packet. The controller requires a reply to each
/// packet within its period, so a `write` must follow even if the command is zero.
///
/// HDAPI: the vendor's servo thread runs a callback every tick. The callback stores the sample in a
/// lock-free slot, wakes `read`, and sets the force of the last `write` once; without a new command
/// the force is zero. A command reaches the motors one tick after its sample; that tick is part of
/// `description().delay_s`.
///
/// A simulated device returns at once; the caller paces it, or drives it in lockstep.
class Driver {
 public:
  virtual ~Driver() = default;
  /// Figures and limits of the device; constant while it is open.
  virtual const DeviceDescription& description() const noexcept = 0;
  /// Returns the newest sample that was not returned before; waits at most `timeout` for it.
  virtual DeviceResult<DeviceSample> read(std::chrono::microseconds timeout) noexcept = 0;
  /// Applies force and torque in D for one period. Refuses commands that are not finite or over a
  /// limit (the last check before the hardware, after the guard; see devices/limits.hpp). A refused
  /// command gives zero force for that period.
  virtual DeviceResult<void> write(const Wrench& command) noexcept = 0;
  /// Sets zero force immediately and drops pending commands. May be called twice. The next accepted
  /// `write` gives force again: to stay at zero, keep the guard stopped.
  virtual void stop() noexcept = 0;
  /// Whether `read` or `write` advances simulated time by one period without waiting, as lockstep
  /// requires.
  virtual bool simulated() const noexcept = 0;
  /// Sets the target of the tip in D, for a device opened with DeviceOptions::is_led; no effect on
  /// others. Owning thread only; real-time safe.
  virtual void lead_hand(const Pose& /*target*/) noexcept {}
  /// Cause and remedy if the device gives no samples or takes no force; else empty. Allocates: not
  /// for the loop, but for any other thread while the loop runs.
  virtual std::string last_error() const { return {}; }
  /// Serial number of the device, constant while it is open; empty if it reports none. Any thread;
  /// real-time safe.
  virtual std::string_view serial() const noexcept { return {}; }
  /// Description of the arm, constant while the device is open; null if it is not an arm or reports
  /// no joints.
  virtual const arm::ArmDescription* arm_description() const noexcept { return nullptr; }
  /// Joint angles of the last sample that `read` returned, if its pose was valid [rad]. Owning
  /// thread only; real-time safe.
  virtual std::span<const double> joints() const noexcept { return {}; }

 protected:
  Driver() = default;
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;
};

}  // namespace voxtouch::devices
