#pragma once
/// The operator of a simulated device: a mass with spring and damper to a target.
#include <limits>

namespace voxtouch::sim {

/// parameters.cpp has the means of grips and arms. All zero: a hand without effect.
struct OperatorConfig {
  bool released = false;  ///< no hand; the other values are unused
  /// Simulated time at which the hand opens; it stays open.
  double release_time_s = std::numeric_limits<double>::infinity();
  /// Simulated time from which stiffness and damping are times `grip_factor`, > 0.
  double grip_change_time_s = std::numeric_limits<double>::infinity();
  double grip_factor = 1.0;
  double mass_kg = 0.0;            ///< moves with the tool
  double damping_ns_per_m = 0.0;   ///< against the target's velocity
  double stiffness_n_per_m = 0.0;  ///< towards the target
  double inertia_kg_m2 = 0.0;      ///< the same three for rotation
  double damping_nms_per_rad = 0.0;
  double stiffness_nm_per_rad = 0.0;
  /// The hand compensates damping and dry friction of the device while its target moves, as
  /// operators learn to. Without it an arm that drags 3 N would stay 15 mm behind its target.
  bool carries_tool = false;
  double tremor_n = 0.0;  ///< standard deviation of a random force on each axis; 0: none
  double tremor_bandwidth_hz = 10.0;  ///< of that force, first order

  /// Throws std::runtime_error that names field, value and rule.
  void validate() const;
};

}  // namespace voxtouch::sim
