#pragma once
/// Reference motion of the strokes: a smooth speed in one direction with tones on top.
#include <array>
#include <cstddef>

#include "core/identification/estimates.hpp"

namespace voxtouch::identification {

struct Tone {
  double omega = 0.0;  ///< [rad/s]
  double speed = 0.0;  ///< amplitude [m/s]
  double phase = 0.0;  ///< [rad]
};

struct ReferencePoint {
  double velocity = 0.0, acceleration = 0.0;  ///< [m/s], [m/s^2]
};

inline constexpr std::size_t kMostTones = 16;

/// A stroke lasts `duration_s`: speed up during the first quarter, slow down during the last.
struct StrokePlan {
  double duration_s = 0.4;
  double path_m = 0.0;  ///< of the tone-free motion
  std::array<Tone, kMostTones> tones{};
  std::size_t tone_count = 0;

  /// At `time_s` from the start of the stroke, `clock_s` for the phase of the tones, of a stroke of
  /// `path_m` (signed). `tone_scale` scales the tones with the speed. Real-time safe.
  ReferencePoint at(double time_s, double clock_s, double path_m, double tone_scale) const noexcept;
};

struct StrokeGoals {
  double allowed_force_n = 0.0;
  double path_m = 0.0;     ///< longest
  double longest_s = 1.8;  ///< of one stroke
  double rate_hz = 1000.0;
  double encoder_step_m = 0.0;
  double lowest_hz = 1.2, highest_hz = 60.0;
  std::size_t tones = 8;
};

/// The stroke that the force allows: friction, viscous force, acceleration and tones within it.
StrokePlan plan_stroke(const AxisModel& model, const StrokeGoals& goals) noexcept;

}  // namespace voxtouch::identification
