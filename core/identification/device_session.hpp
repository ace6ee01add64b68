#pragma once
/// All axes of a device, one after the other; weak springs keep the others at the start pose.
#include <array>

#include "core/identification/axis_identification.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::identification {

struct SessionOptions {
  AxisLimits limits;
  std::array<bool, 3> axes{true, true, true};
};

/// Result of a fit: a model to continue with, or the figures of a finished axis.
struct FitResult {
  AxisModel model;
  AxisFigures figures;
};

/// Pulses and probe strokes give a model, the whole record gives figures. Allocates.
FitResult fit(const FitInput& input);

/// The loop calls `step` with each sample and `applied` with the force after the guard. When
/// `waiting()`, `fit` may run in another thread while `step` keeps the axis in place; the loop then
/// calls `resume`.
class DeviceSession {
 public:
  /// Allocates.
  void start(const SessionOptions& options);

  /// Force in reply to a sample [N]. Real-time safe.
  Vec3 step(double time_s, const Vec3& position_m) noexcept;
  void applied(const Vec3& force_n) noexcept;

  bool waiting() const noexcept { return axis_ < 3 && excitation_[axis_].waiting(); }
  bool finished() const noexcept { return axis_ >= 3; }
  /// Of the current axis, for `fit`. Call it in the loop's thread.
  FitInput fit_input() const noexcept { return excitation_[axis_].fit_input(); }
  /// Real-time safe.
  void resume(const FitResult& result) noexcept;
  /// Ends at zero force, for example on Ctrl-C.
  void stop() noexcept { axis_ = 3; }

  std::size_t axis() const noexcept { return axis_; }
  const AxisFigures& figures(std::size_t axis) const noexcept { return figures_[axis]; }
  const AxisExcitation& excitation(std::size_t axis) const noexcept { return excitation_[axis]; }
  /// The outcome that ended the session early; kMeasured: none did.
  Outcome outcome() const noexcept { return outcome_; }

 private:
  void next_axis() noexcept;

  SessionOptions options_;
  std::array<AxisExcitation, 3> excitation_;
  std::array<HoldingSpring, 3> spring_;
  std::array<AxisFigures, 3> figures_;
  std::array<double, 3> start_{}, rest_{}, rest_force_n_{}, last_{};
  double last_time_s_ = 0.0;
  std::size_t axis_ = 0;
  bool first_ = true;
  Outcome outcome_ = Outcome::kMeasured;
};

}  // namespace voxtouch::identification
