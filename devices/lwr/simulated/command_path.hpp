#pragma once
/// Converts one reply per period to set points every millisecond.
#include "devices/lwr/simulated/lwr_plant.hpp"

namespace voxtouch::lwr_sim {

/// Interpolates longer periods and extrapolates missing replies. Positions of a missed period
/// continue as in the last one, for at most `kExtrapolated` consecutive misses; torques are
/// repeated. Real-time safe.
class CommandPath {
 public:
  static constexpr int kExtrapolated = 3;  ///< assumed

  /// `ticks_per_period` of 1 ms each.
  explicit CommandPath(int ticks_per_period) noexcept;

  /// Restarts at rest at `start`.
  void start(const Setpoint& start) noexcept;
  /// A reply at the start of a period: reached at its end.
  void answer(const Setpoint& requested) noexcept;
  /// No reply for this period.
  void miss() noexcept;
  /// The set point over the next millisecond, with the gains of the last reply.
  Setpoint tick() noexcept;

  /// Goal of the last reply or of its replacement.
  const Setpoint& goal() const noexcept { return to_; }

 private:
  void begin(const Setpoint& requested) noexcept;

  int ticks_, done_ = 0, misses_ = 0;
  Setpoint from_, to_;
  lwr::LwrJoints position_step_ = lwr::LwrJoints::Zero();  // over the last period
};

}  // namespace voxtouch::lwr_sim
