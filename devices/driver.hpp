#pragma once
/// What every haptic device, real or simulated, is to the rest of the project.
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

/// Why a call in the loop failed. A kind exists where the caller does something different about it.
enum class DeviceError : std::uint8_t {
  kTimeout,       ///< no sample within the time given; the device may still be there
  kDisconnected,  ///< the device or its controller has gone
  kNotFinite,     ///< a command held NaN or Inf; it was not sent
  kLimit,         ///< a command was over a limit; it was not sent
  kProtocol,      ///< the device said something that its protocol forbids
  kRecoverable,   ///< the device dropped its force (warm motors, too fast) and will take commands
                  ///< again
  kFault,         ///< the device stopped and needs a person
};
/// One word, for logs and messages. Real-time safe.
std::string_view name_of(DeviceError error) noexcept;

template <class T>
using DeviceResult = std::expected<T, DeviceError>;

/// A device could not be opened; says what happened and what to do.
struct DeviceOpenError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One sample, in frame D, at the tool's origin.
struct DeviceSample {
  std::int64_t time_ns = 0;   ///< the device's clock, growing; simulated time in a simulated device
  Pose pose;                  ///< T in D
  Twist twist;                ///< D axes; filtered by the device, so it lags the pose
  std::uint32_t buttons = 0;  ///< bit 0 = first button
  bool pose_valid = true;     ///< false: the device marked the sample as not to be trusted
};

/// An open device. It exists only while connected; destruction and every error path end in zero
/// force.
///
/// One thread owns a driver: `read`, then one `write`, once a period. All three calls below are
/// real-time safe: no allocation, no lock that a slower thread holds, no log, no throw.
///
/// Who paces the loop: a real device does, and `read` blocks until its next sample, so the caller
/// does not sleep.
///  - FRI: `read` waits for the next measurement packet. The controller wants an answer to each one
///  within
///    its period, so the `write` that follows is due even where the command is zero; leaving it out
///    costs connection quality.
///  - HDAPI: the vendor's servo thread runs a callback every tick. The callback puts the sample
///  into a
///    lock-free slot, wakes `read`, and sets the force that the last `write` left, once: a tick
///    that finds no new command sets none, which that interface turns into zero. A command thus
///    reaches the motors one tick after the sample that it answers; that tick is part of
///    `description().delay_s`.
/// A simulated device answers at once; the caller paces it, or drives it in lockstep.
class Driver {
 public:
  virtual ~Driver() = default;
  /// What the device is and can give; the same from opening to the end.
  virtual const DeviceDescription& description() const noexcept = 0;
  /// The next sample that has not been given out yet, the newest if several have come; waits at
  /// most `timeout` for it.
  virtual DeviceResult<DeviceSample> read(std::chrono::microseconds timeout) noexcept = 0;
  /// Force and torque in D, applied for one period. Refuses non-finite and over-limit commands (the
  /// last check before the hardware, in addition to the guard's; see limits.hpp): a refused command
  /// is zero force for that period, not the one before it.
  virtual DeviceResult<void> write(const Wrench& command) noexcept = 0;
  /// Zero force, now; what is still under way to the motors is dropped. Safe to call twice. The
  /// next accepted `write` pushes again: whoever has to stay at zero keeps its guard stopped.
  virtual void stop() noexcept = 0;
  /// True where `write`, or `read`, advances simulated time by one period and `read` needs no
  /// waiting (lockstep can drive it).
  virtual bool simulated() const noexcept = 0;
  /// Where the hand of a device that was opened with DeviceOptions::is_led wants the tip to be, in
  /// D; nothing on any other. Of the thread that owns it; real-time safe.
  virtual void lead_hand(const Pose& /*target*/) noexcept {}
  /// What keeps the device from giving samples or taking force now, and what to do about it; empty:
  /// nothing that it knows of. For people: allocates, so not for the loop, but any other thread may
  /// ask while the loop runs.
  virtual std::string last_error() const { return {}; }
  /// The device's own serial number, the same from opening to the end; empty: it reports none. Any
  /// thread; real-time safe.
  virtual std::string_view serial() const noexcept { return {}; }
  /// The arm that the device is, the same from opening to the end; null where it is none, or its
  /// joints are not reported.
  virtual const arm::ArmDescription* arm_description() const noexcept { return nullptr; }
  /// Angles of its joints in the last sample that `read` gave, if that had a valid pose [rad]. Of
  /// the thread that owns it; real-time safe.
  virtual std::span<const double> joints() const noexcept { return {}; }

 protected:
  Driver() = default;
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;
};

}  // namespace voxtouch::devices
