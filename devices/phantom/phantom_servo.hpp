#pragma once
/// The part of the driver that runs in the library's servo thread: one frame per tick.
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <limits>

#include "core/types/latest_value.hpp"
#include "devices/driver.hpp"
#include "devices/phantom/hd_errors.hpp"
#include "devices/phantom/hd_library.hpp"
#include "devices/phantom/phantom_models.hpp"
#include "devices/phantom/thermal_clamp.hpp"
#include "devices/phantom/twist_estimate.hpp"
#include "devices/phantom/wake_up.hpp"

namespace voxtouch::phantom {

/// Result of a tick.
struct ServoSample {
  devices::DeviceSample sample;  ///< time since the clock's zero
  double force_limit_n = 0.0;    ///< of the thermal clamp
};

struct ServoCounts {
  std::atomic<std::uint64_t> ticks{0};
  std::atomic<std::uint64_t> late{0};  ///< ticks more than half a period late
  std::atomic<std::uint64_t> superseded{
      0};  ///< samples superseded by a newer one without being read
  std::atomic<std::uint64_t> invalid_poses{0};
  std::atomic<std::uint64_t> applied{0};  ///< ticks that set a force
  std::atomic<std::uint64_t> withheld{
      0};  ///< commands dropped in their tick because of an error or an invalid pose
  std::atomic<std::uint64_t> thermal{0};  ///< forces reduced because motors are warm
};

/// A tick: begin a frame, read, set the waiting command, end the frame. Errors are read first,
/// again when the command is to be set, and after the end. A command is set only if no error has
/// occurred since its `write` and the pose of the tick is valid. Otherwise the tick sets nothing,
/// which is zero force.
class PhantomServo {
 public:
  using Clock = std::chrono::steady_clock;

  PhantomServo(const HdLibrary& library, hd::HHD device, const PhantomFacts& facts,
               const DeviceDescription& description, double velocity_cutoff_hz,
               bool virtual_time) noexcept;
  PhantomServo(const PhantomServo&) = delete;
  PhantomServo& operator=(const PhantomServo&) = delete;

  /// The callback; `self` is this object.
  static hd::HDCallbackCode run(void* self) noexcept;

  // --- for the thread that owns the driver; real-time safe
  /// Waits until `deadline`; returns at once if it has passed. Returns false if there is no unread
  /// sample.
  bool take(ServoSample& out, Clock::time_point deadline) noexcept;
  /// Sets the command of the next tick. `errors`: error count seen by the writer.
  void set_command(const Wrench& command, std::uint64_t errors) noexcept {
    commands_.put({command, errors, true});
  }
  /// Makes the next tick set no force.
  void drop() noexcept { commands_.put({}); }
  /// Removes the force without a tick, if the servo loop has stopped. A tick with a command turns
  /// it on again, from the start of the device's ramp.
  void force_off() noexcept;
  /// Time since the last tick, or since construction.
  Clock::duration silence() const noexcept;

  HdErrorLog& errors() noexcept { return errors_; }
  const HdErrorLog& errors() const noexcept { return errors_; }
  const ServoCounts& counts() const noexcept { return counts_; }
  /// Sets the rate by which late ticks and gaps are detected.
  void set_rate(double rate_hz) noexcept;

 private:
  struct Command {
    Wrench wrench;
    std::uint64_t errors = 0;
    bool active = false;
  };
  /// A frame in the library's units.
  struct Raw {
    static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    std::array<double, 3> position{kNone, kNone, kNone};
    std::array<double, 16> transform{kNone};  // only the first is checked for the others
    std::array<double, 16> temperature{};
    int buttons = 0;
  };
  void tick() noexcept;
  void read_frame() noexcept;
  void publish() noexcept;
  std::int64_t now_ns() const noexcept;
  void update(std::int64_t now_ns, bool frame_good) noexcept;
  bool update_pose() noexcept;
  void answer() noexcept;
  void set(const Wrench& wrench) noexcept;

  const hd::Api& api_;
  const HdSimHooks& hooks_;
  hd::HHD device_;
  int temperatures_;
  bool virtual_time_;
  double max_torque_nm_;
  std::atomic<std::int64_t> period_ns_;

  HdErrorLog errors_;
  ThermalClamp clamp_;
  TwistEstimate twist_;
  Raw raw_;
  ServoSample seen_;
  std::int64_t last_ns_ = 0;
  double set_n_ = 0.0;  // force of the last tick
  bool first_ = true, ended_ = false;

  LatestValue<ServoSample> samples_;
  LatestValue<Command> commands_;
  WakeUp wake_up_;
  std::atomic<std::int64_t> last_tick_;  // of Clock
  std::atomic<bool> force_off_{false};
  ServoCounts counts_;
};

}  // namespace voxtouch::phantom
