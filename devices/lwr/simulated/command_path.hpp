#pragma once
/// From one answer a period to set points every millisecond.
#include "devices/lwr/simulated/lwr_plant.hpp"

namespace voxtouch::lwr_sim {

/// Fine interpolation of longer periods, and extrapolation over misses. Positions
/// of a missed period go on as in the last one, for at most `kExtrapolated` misses in a row; forces
/// stay as they are. Real-time safe.
class CommandPath {
 public:
  static constexpr int kExtrapolated = 3;  ///< assumed

  /// `ticks_per_period` of 1 ms each.
  explicit CommandPath(int ticks_per_period) noexcept;

  /// Begins anew: rests at `start`.
  void start(const Setpoint& start) noexcept;
  /// An answer at the begin of a period: reached at its end.
  void answer(const Setpoint& requested) noexcept;
  /// No answer came for this period.
  void miss() noexcept;
  /// The set point over the next millisecond. Gains are the last answer's.
  Setpoint tick() noexcept;

  /// Where the last answer, or what replaced it, requested to go.
  const Setpoint& goal() const noexcept { return to_; }

 private:
  void begin(const Setpoint& requested) noexcept;

  int ticks_, done_ = 0, misses_ = 0;
  Setpoint from_, to_;
  lwr::LwrJoints position_step_ = lwr::LwrJoints::Zero();  // over the last period
};

}  // namespace voxtouch::lwr_sim
