#pragma once
/// When an excitation must end at once, and the force that a mass can take.
#include <cstddef>
#include <cstdint>

#include <array>
#include <optional>

#include "core/identification/estimates.hpp"

namespace voxtouch::identification {

/// Bounds of one axis, relative to its start.
struct AxisLimits {
  double period_s = 1e-3;
  double allowed_force_n = 0.0;  ///< for example 20 % of the device's force
  double box_m = 0.02;
  double speed_m_per_s = 0.35;
};

/// Checks each sample. Real-time safe, no allocation.
class SafetyRules {
 public:
  void start(const AxisLimits& limits) noexcept;
  /// The first rule that the sample breaks. `encoder_step_m`: 0 while unknown.
  std::optional<Outcome> check(double time_s, double position_m, double encoder_step_m) noexcept;
  /// The reference while strokes run: following error and a stuck encoder.
  std::optional<Outcome> check_reference(double reference_m, double position_m,
                                         double encoder_step_m) noexcept;
  /// A new reference begins at the measured position.
  void restart_reference(double reference_m) noexcept;
  double origin_m() const noexcept { return origin_; }

 private:
  static constexpr std::size_t kKept = 64;
  struct Point {
    double time_s, position_m;
  };
  AxisLimits limits_;
  std::array<Point, kKept> points_{};
  std::size_t count_ = 0;
  double origin_ = 0.0, last_time_ = 0.0;
  bool started_ = false;
  int invalid_ = 0;
  double reference_ = 0.0, path_without_increment_ = 0.0, last_position_ = 0.0;
};

/// The force that leaves time to stop: within t_r = 2.4 T + tau + 2 ms the mass gains at most 0.25
/// m/s.
///
///     F = Fc + |c| + m * 0.25 m/s / t_r
double force_that_mass_takes(const AxisModel& model, double period_s) noexcept;

}  // namespace voxtouch::identification
