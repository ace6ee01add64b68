#pragma once
/// A weak spring and damper that keep an axis in place.
#include "core/identification/estimates.hpp"

namespace voxtouch::identification {

/// The gains start at 1/32 and double every 0.2 s while the oscillation does not grow; growth
/// divides them by 8. If the axis moves away (gravity that the driver does not compensate), they
/// double every 8 ms until it stops. Once the mass is known they follow it. Real-time safe.
class HoldingSpring {
 public:
  void start() noexcept { *this = {}; }
  /// Gains for this mass and delay; noise of the encoder takes at most a tenth of `force_n`.
  void follow(const AxisModel& model, double period_s, double encoder_step_m,
              double force_n) noexcept;

  /// New sample: updates the velocity and the gains.
  void sample(double time_s, double position_m, double encoder_step_m) noexcept;
  /// Towards `position_m` at `velocity_m_per_s` [N].
  double force(double position_m, double velocity_m_per_s) const noexcept;
  double velocity() const noexcept { return velocity_; }
  double stiffness() const noexcept { return gain_ * stiffness_; }
  /// Position at its start.
  double rest_position_m() const noexcept { return rest_position_; }

 private:
  void catch_fall(double time_s, double encoder_step_m) noexcept;
  void raise_gains(double time_s, double encoder_step_m) noexcept;

  double stiffness_ = 20.0, damping_ = 1.0;  // [N/m], [Ns/m]
  double gain_ = 1.0 / 32.0;
  bool follows_mass_ = false, first_ = true;
  double time_ = 0.0, position_ = 0.0, velocity_ = 0.0;
  double interval_start_ = 0.0, caught_s_ = 0.0, rest_position_ = 0.0, low_ = 0.0, high_ = 0.0,
         last_range_ = -1.0;
};

}  // namespace voxtouch::identification
