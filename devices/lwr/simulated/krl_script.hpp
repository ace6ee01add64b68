#pragma once
/// Simulates the KRL program that runs on the controller next to the interface and calls friStart
/// and friStop.
#include <cstdint>
#include <optional>

#include "devices/lwr/fri_packets.hpp"

namespace voxtouch::lwr_sim {

/// The common handshake of published KRL programs: $FRI_FRM_INT[1] is the requested strategy,
/// $FRI_FRM_INT[2] is 1 for friStart and 0 for friStop, and $FRI_TO_INT[2] echoes it, with 10
/// initially. The program loops with a pause and starts when the quality is PERFECT. After command
/// mode has ended by itself, it restarts only after a 0. Real-time safe.
class KrlScript {
 public:
  /// kAcknowledge: no run is active or requested, so errors may be cleared.
  enum class Request : std::uint8_t { kNone, kStart, kStop, kAcknowledge };
  struct Input {
    std::int32_t strategy = 0, run = 0;  ///< $FRI_FRM_INT[1], [2]
    lwr::fri::State state = lwr::fri::State::kMon;
    lwr::fri::Quality quality = lwr::fri::Quality::kUnacceptable;
  };

  /// `first_start_keeps_strategy`: one published program adopts the strategy only from the second
  /// start on.
  KrlScript(double pause_s, bool first_start_keeps_strategy) noexcept
      : pause_s_(pause_s),
        first_start_keeps_strategy_(first_start_keeps_strategy) {}

  /// Call once per period.
  Request step(const Input& input, double elapsed_s) noexcept;
  /// friStart has led to command mode.
  void started() noexcept { echo_ = lwr::fri::kRun; }

  std::int32_t echo() const noexcept { return echo_; }
  lwr::fri::Control control() const noexcept { return control_; }  ///< of $stiffness.strategy

 private:
  double pause_s_, waited_s_ = 0.0;
  bool first_start_keeps_strategy_;
  std::int32_t echo_ = lwr::fri::kKrlInitialised;
  lwr::fri::Control control_ = lwr::fri::Control::kPosition;
};

/// nullopt for an undefined strategy, and for Cartesian impedance, which is not simulated.
std::optional<lwr::fri::Control> control_of(std::int32_t strategy) noexcept;

}  // namespace voxtouch::lwr_sim
