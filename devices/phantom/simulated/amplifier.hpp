#pragma once
/// From what a frame asked for to the torque of the motors: overrides, limits, ramp, heat,
/// watchdog.
#include <optional>

#include "devices/phantom/hdapi.hpp"
#include "devices/phantom/simulated/models.hpp"
#include "devices/phantom/simulated/plant.hpp"
#include "devices/phantom/simulated/sensors.hpp"

namespace voxtouch::hd_sim {

/// What was set between begin and end of a frame. Absent: not set.
struct Setpoint {
  std::optional<Vec3> force;   ///< [N]
  std::optional<Vec3> torque;  ///< [Nm]; the arm that is simulated gives none
};

/// What a caller may switch and set. Which are on at first is assumed.
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

/// One device's electronics. Errors come back as codes, kSuccess where there is none. Real-time
/// safe.
class Amplifier {
 public:
  Amplifier(const Model& model, const PlantConfig& plant, double thermal_time_s,
            double watchdog_s) noexcept;

  Limits limits;

  /// Once a tick, before anything else: speed, heat, and the ramp by one period.
  phantom::hd::HDerror begin_tick(const Reading& reading, double period_s) noexcept;
  /// Takes what a frame asked for; the pose is the one that the frame saw. The torque holds until
  /// the next flush.
  phantom::hd::HDerror flush(const Setpoint& setpoint, const Reading& reading,
                             double period_s) noexcept;
  /// Torque of the motors over the next substep [Nm].
  const Vec3& advance(double dt_s) noexcept;

  /// Zero at once; what was held is forgotten.
  void release() noexcept;
  /// Zero, and the ramp from its start: what a scheduler's start and a force error come to.
  void restart_ramp() noexcept;
  /// Off until turned on again: a device that has failed.
  void set_power(bool on) noexcept;

  const Vec3& temperature() const noexcept { return temperature_; }  ///< 1: too hot
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
