#pragma once
/// From the values set in a frame to the motor torques: overrides, limits, ramp, heat, watchdog.
#include <optional>

#include "devices/phantom/hdapi.hpp"
#include "devices/phantom/simulated/models.hpp"
#include "devices/phantom/simulated/plant.hpp"
#include "devices/phantom/simulated/sensors.hpp"

namespace voxtouch::hd_sim {

/// Values set between begin and end of a frame. Absent: not set.
struct Setpoint {
  std::optional<Vec3> force;   ///< [N]
  std::optional<Vec3> torque;  ///< [Nm]; the simulated arm gives none
};

/// Switches and limits that a caller may set. Their initial state is assumed.
struct Limits {
  bool force_output = false;
  bool clamping = false;
  bool ramping = false;
  bool force_limit = true;
  bool one_frame = true;
  bool velocity_limit_on = true;
  bool impulse_limit_on = true;
  double velocity_limit_m_per_s = 1.5;
  double impulse_limit_n_per_ms = 10.0;
  double ramp_n_per_s = 20.0;
};

/// The electronics of one device. Errors are returned as codes, kSuccess without an error.
/// Real-time safe.
class Amplifier {
 public:
  Amplifier(const Model& model, const PlantConfig& plant, double thermal_time_s,
            double watchdog_s) noexcept;

  Limits limits;

  /// Called first in each tick: speed, heat, and one period of the ramp.
  phantom::hd::HDerror begin_tick(const Reading& reading, double period_s) noexcept;
  /// Applies the values of a frame; the pose is that of the frame. The torque holds until the next
  /// flush.
  phantom::hd::HDerror flush(const Setpoint& setpoint, const Reading& reading,
                             double period_s) noexcept;
  /// Torque of the motors over the next substep [Nm].
  const Vec3& advance(double dt_s) noexcept;

  /// Sets zero torque at once and discards the latched value.
  void release() noexcept;
  /// Sets zero torque and restarts the ramp: effect of a scheduler start and of a force error.
  void restart_ramp() noexcept;
  /// Stays off until turned on again: a failed device.
  void set_power(bool on) noexcept;

  const Vec3& temperature() const noexcept { return temperature_; }  ///< 1: overheated
  void set_temperature(double value) noexcept { temperature_.setConstant(value); }
  bool dropping() const noexcept { return warm_ || too_fast_; }

 private:
  phantom::hd::HDerror limit(Vec3& force, double period_s) noexcept;
  phantom::hd::HDerror drop(phantom::hd::HDerror code) noexcept;

  const Model* model_;
  phantom::PhantomGeometry geometry_;
  Vec3 motor_limit_, continuous_;
  double thermal_time_s_, watchdog_s_;
  Vec3 torque_ = Vec3::Zero(), temperature_ = Vec3::Zero(), force_ = Vec3::Zero();
  double ceiling_n_ = 0.0, age_s_ = 0.0;
  bool power_ = true, warm_ = false, too_fast_ = false;
};

}  // namespace voxtouch::hd_sim
