#pragma once
/// The sampled half of the simulated loop: wall, coupling, injected damping.
#include <deque>
#include <utility>

#include "core/coupling/spring_damper.hpp"
#include "tests/support/coupling_models/nonlinear_loop.hpp"
#include "tests/support/coupling_models/pt2.hpp"

namespace voxtouch::coupling_models {

/// Effort of the wall, positive against the penetration, at `position`.
double wall_effort(WallLaw law, double stiffness, double knee, double position) noexcept;

/// The coupling's computation for one sample's position.
class LoopLaw {
 public:
  explicit LoopLaw(const NonlinearLoop& loop);
  /// The effort for the device, negative against a penetration. `position` as measured, or the last
  /// one if it was lost.
  double step(double position, double stiffness, double period_s);
  bool saturated() const noexcept { return saturated_; }  ///< in the last step

 private:
  double coupled(double wall, double stiffness, double period_s) noexcept;
  double velocity(double position, double period_s);
  double filtered(double rad_per_s, double before, double difference, double period_s) const;
  double velocity_of_window(double position, double period_s);

  coupling::design::LoopController controller_;
  WallLaw wall_;
  double knee_, damping_fraction_, damping_free_, max_effort_, input_limit_, nominal_s_,
      slow_rad_per_s_, velocity_band_;
  bool only_in_contact_, measured_period_, saturated_ = false, started_ = false;
  Pt2 filter_;
  coupling::UnilateralSpringDamper spring_damper_;
  double offset_ = 0.0;  ///< of the spring-damper's object, bilateral wall
  double last_position_ = 0.0, velocity_ = 0.0, slow_velocity_ = 0.0;
  std::deque<std::pair<double, double>>
      past_;  ///< of a window: positions and the periods that led to them, the newest first
};

}  // namespace voxtouch::coupling_models
