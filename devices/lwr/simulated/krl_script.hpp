#pragma once
/// Stand-in for the KRL program that runs on the controller next to the interface, and decides
/// about friStart and friStop.
#include <cstdint>
#include <optional>

#include "devices/lwr/fri_packets.hpp"

namespace voxtouch::lwr_sim {

/// The handshake that published KRL programs share: $FRI_FRM_INT[1] is the requested strategy,
/// $FRI_FRM_INT[2] is 1 for friStart and 0 for friStop, $FRI_TO_INT[2] echoes it, 10 before the
/// first. The program loops with a pause; it starts when the quality is PERFECT. Command mode that
/// ended by itself is not entered again before a 0 was seen. Real-time safe.
class KrlScript {
 public:
  enum class Request : std::uint8_t {
    kNone,
    kStart,
    kStop,
    kAcknowledge
  };  ///< the last: nothing runs or is to, errors may go
  struct Input {
    std::int32_t strategy = 0, run = 0;  ///< $FRI_FRM_INT[1], [2]
    lwr::fri::State state = lwr::fri::State::kMon;
    lwr::fri::Quality quality = lwr::fri::Quality::kUnacceptable;
  };

  /// `first_start_keeps_strategy`: one published program takes the strategy over only from the
  /// second start on.
  KrlScript(double pause_s, bool first_start_keeps_strategy) noexcept
      : pause_s_(pause_s),
        first_start_keeps_strategy_(first_start_keeps_strategy) {}

  /// Once a period.
  Request step(const Input& input, double elapsed_s) noexcept;
  /// friStart led to command mode.
  void started() noexcept { echo_ = lwr::fri::kRun; }

  std::int32_t echo() const noexcept { return echo_; }
  lwr::fri::Control control() const noexcept { return control_; }  ///< of $stiffness.strategy

 private:
  double pause_s_, waited_s_ = 0.0;
  bool first_start_keeps_strategy_;
  std::int32_t echo_ = lwr::fri::kKrlInitialised;
  lwr::fri::Control control_ = lwr::fri::Control::kPosition;
};

/// nullopt for a number that is no strategy, and for Cartesian impedance, which is not simulated.
std::optional<lwr::fri::Control> control_of(std::int32_t strategy) noexcept;

}  // namespace voxtouch::lwr_sim
