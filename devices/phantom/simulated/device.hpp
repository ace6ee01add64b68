#pragma once
/// One simulated Phantom: arm, encoders, electronics, and the rules of frames and calibration. No
/// clock and no thread: whoever owns it makes its ticks.
#include <cstdint>

#include "devices/phantom/simulated/amplifier.hpp"
#include "devices/phantom/simulated/error_stack.hpp"
#include "devices/phantom/simulated/sensors.hpp"
#include "devices/phantom/simulated/settings.hpp"

namespace voxtouch::hd_sim {

inline constexpr phantom::hd::HHD kHandle =
    0;  // the vendor's first handle is 0 as well: no driver may take it for "none"

struct Switches {
  int buttons = 0;
  bool safety = true, inkwell = false;
};

/// What a frame saw.
struct Frame {
  Reading reading;
  Switches switches;
  Setpoint setpoint;
  bool position_lost = false;  ///< planted: positions read as NaN
};

/// How many ticks each fault has yet to go; negative: for good.
struct Faults {
  long communication = 0, device = 0, lost_position = 0;
};

class Device {
 public:
  /// Throws as PhantomPlant does.
  explicit Device(const Settings& settings);

  // --- frames; all real-time safe. `servo_runs`: the servo loop ticks, so that what is set takes
  // effect.
  /// Takes the snapshot that the frame shows. kIllegalBegin: one is open, or has been in this tick.
  phantom::hd::HDerror begin_frame(bool servo_runs) noexcept;
  /// Gives what was set to the amplifier. kIllegalEnd: no frame is open.
  phantom::hd::HDerror end_frame(bool servo_runs) noexcept;
  bool frame_open() const noexcept { return frame_open_; }
  const Frame& current() const noexcept {
    return current_;
  }  ///< of this frame, or the last where none is open
  /// For sets; only while a frame is open.
  Setpoint& setpoint() noexcept { return current_.setpoint; }
  /// Ends a frame that was left open; what was set in it is lost.
  void close_frame() noexcept { frame_open_ = false; }
  /// What switching force output comes to. No order reaches an amplifier that communication is lost
  /// to.
  void restart_ramp() noexcept {
    if (faults.communication == 0)
      amplifier.restart_ramp();
  }

  // --- time. A tick is begin_tick, the callbacks, end_tick; the first is left out where the servo
  // loop missed it.
  /// Reads the sensors and judges heat and speed; what is wrong goes to `errors`. Real-time safe,
  /// like the next three.
  void begin_tick(ErrorStack& errors) noexcept;
  /// The arm moves on by a period, and faults on a count of ticks come nearer to their end.
  void end_tick() noexcept;
  /// The arm moves on under what the amplifier holds.
  void advance(int substeps) noexcept;
  /// Of the arm in a tick: the tick's length. The velocity starts anew.
  void set_substeps(int substeps) noexcept;
  int substeps() const noexcept { return substeps_; }
  double period_s() const noexcept { return substeps_ * kSubstep; }  ///< of a tick [s]

  // --- calibration
  /// What it needs next: nothing, an update, or a hand.
  phantom::hd::HDenum calibration() const noexcept;
  /// kInvalidValue: not this model's style. kInvalidOperation: forces are on, or the arm does not
  /// stand as it must.
  phantom::hd::HDerror calibrate(phantom::hd::HDenum style, bool servo_runs) noexcept;

  PhantomPlant plant;
  Amplifier amplifier;
  Switches switches;
  Faults faults;
  std::uint64_t ticks = 0, non_finite_sets = 0;

  const Model& model() const noexcept { return *settings_.model; }
  const Settings& settings() const noexcept { return settings_; }

 private:
  void sense() noexcept;

  Settings settings_;
  Sensors sensors_;
  Frame current_;
  int substeps_ = 8;
  bool frame_open_ = false, framed_this_tick_ = false, calibrated_ = false;
};

}  // namespace voxtouch::hd_sim
