#pragma once
/// One simulated Phantom: arm, encoders, electronics, and the rules of frames and calibration. It
/// has no clock or thread; its owner makes its ticks.
#include <cstdint>

#include "devices/phantom/simulated/amplifier.hpp"
#include "devices/phantom/simulated/error_stack.hpp"
#include "devices/phantom/simulated/sensors.hpp"
#include "devices/phantom/simulated/settings.hpp"

namespace voxtouch::hd_sim {

// The vendor's first handle is also 0: a driver must not treat it as "none".
inline constexpr phantom::hd::HHD kHandle = 0;

struct Switches {
  int buttons = 0;
  bool safety = true, inkwell = false;
};

/// State captured by a frame.
struct Frame {
  Reading reading;
  Switches switches;
  Setpoint setpoint;
  bool position_lost = false;  ///< injected: positions read as NaN
};

/// Remaining ticks of each fault; negative: permanent.
struct Faults {
  long communication = 0, device = 0, lost_position = 0;
};

class Device {
 public:
  /// Throws as PhantomPlant does.
  explicit Device(const Settings& settings);

  // --- frames; all real-time safe. `servo_runs`: the servo loop ticks, so that set values take
  // effect.
  /// Takes the snapshot for the frame. kIllegalBegin: a frame is open, or there was one in this
  /// tick.
  phantom::hd::HDerror begin_frame(bool servo_runs) noexcept;
  /// Passes the set values to the amplifier. kIllegalEnd: no frame is open.
  phantom::hd::HDerror end_frame(bool servo_runs) noexcept;
  bool frame_open() const noexcept { return frame_open_; }
  /// Of this frame, or of the last one if none is open.
  const Frame& current() const noexcept { return current_; }
  /// For set calls; only while a frame is open.
  Setpoint& setpoint() noexcept { return current_.setpoint; }
  /// Ends an open frame; its set values are lost.
  void close_frame() noexcept { frame_open_ = false; }
  /// Effect of switching force output. Without communication, no command reaches the amplifier.
  void restart_ramp() noexcept {
    if (faults.communication == 0)
      amplifier.restart_ramp();
  }

  // --- time. A tick is begin_tick, the callbacks, end_tick; begin_tick is omitted if the servo
  // loop missed it.
  /// Reads the sensors and checks heat and speed; errors go to `errors`. Real-time safe, like the
  /// next three.
  void begin_tick(ErrorStack& errors) noexcept;
  /// Advances the arm by one period, and faults counted in ticks towards their end.
  void end_tick() noexcept;
  /// Advances the arm under the torque that the amplifier holds.
  void advance(int substeps) noexcept;
  /// Sets the substeps of the arm per tick, which is the tick's length. The velocity restarts.
  void set_substeps(int substeps) noexcept;
  int substeps() const noexcept { return substeps_; }
  double period_s() const noexcept { return substeps_ * kSubstep; }  ///< of a tick [s]

  // --- calibration
  /// The next calibration step: none, an update, or a manual one.
  phantom::hd::HDenum calibration() const noexcept;
  /// kInvalidValue: not the style of this model. kInvalidOperation: forces are on, or the pose of
  /// the arm is wrong.
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
