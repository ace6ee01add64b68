#pragma once
/// From one answer a period to set points every millisecond.
#include <array>
#include <cstddef>

#include "devices/lwr/simulated/lwr_plant.hpp"

namespace voxtouch::lwr_sim {

/// Fine interpolation of longer periods, extrapolation over misses, and the way of the overlaid
/// torque to the joints. Positions of a missed period go on as in the last one, for at most
/// `kExtrapolated` misses in a row; forces stay as they are. Real-time safe.
class CommandPath {
 public:
  static constexpr int kExtrapolated = 3;  ///< assumed
  static constexpr std::size_t kMaxDelay = 100;

  /// `ticks_per_period` of 1 ms each. `delay_ticks` (at most kMaxDelay): what overlaid torques need
  /// on top.
  CommandPath(int ticks_per_period, std::size_t delay_ticks) noexcept;

  /// Begins anew: rests at `start`, no force under way.
  void start(const Setpoint& start) noexcept;
  /// An answer at the begin of a period: reached at its end.
  void answer(const Setpoint& wanted) noexcept;
  /// No answer came for this period.
  void miss() noexcept;
  /// The set point over the next millisecond. Gains are the last answer's; forces come out late by
  /// the delay.
  Setpoint tick() noexcept;

  /// Where the last answer, or what stood in for it, wanted to go.
  const Setpoint& goal() const noexcept { return to_; }

 private:
  void begin(const Setpoint& wanted) noexcept;

  int ticks_, done_ = 0, misses_ = 0;
  std::size_t delay_, next_ = 0;
  Setpoint from_, to_;
  lwr::LwrJoints position_step_ = lwr::LwrJoints::Zero();  // over the last period
  std::array<lwr::LwrJoints, kMaxDelay + 1> line_;         // torques on their way
};

}  // namespace voxtouch::lwr_sim
