#pragma once
/// The last check before any device: the output is finite, within the limits, and fades when
/// commands stop.
#include <cstdint>
#include <optional>

#include "devices/command_gate.hpp"
#include "devices/driver.hpp"

namespace voxtouch::devices {

/// Limits of the guard. Infinity: no slew limit.
struct GuardConfig {
  double period_s = 1e-3;
  double max_force_n = 0.0;  ///< (0, finite)
  double max_torque_nm =
      0.0;  ///< [0, finite); 0: the device gives no torque, so torque is left out
  double max_force_rate_n_per_s =
      0.0;  ///< derive_slew_limits; at least max_force_n / fade_s, for fades
  double max_torque_rate_nm_per_s = 0.0;  ///< for torque
  double hold_periods = 3.0;              ///< longest time that a command is repeated, [1, 1000]
  double fade_s = 0.02;                   ///< then it is zero after this, (0, 1]
  double start_ramp_s = 0.5;            ///< at the start full force is reached after this, [0, 10]
  double return_ramp_s = kReturnRampS;  ///< ramp after a fade, [0, 10]

  /// Throws std::runtime_error that names field, value and rule.
  void validate() const;
};

/// The guard that fits a device, with the times above.
GuardConfig guard_config(const DeviceDescription& device) noexcept;

/// A new command, in frame D.
struct GuardInput {
  Wrench wrench;
  std::int64_t valid_until_ns = 0;  ///< the device's clock; from then on the command fades
};

struct GuardCounts {
  std::uint64_t passed = 0;  ///< commands taken, clamped ones among them
  std::uint64_t refused_not_finite = 0;
  std::uint64_t refused_stale = 0;   ///< expired on arrival
  std::uint64_t refused_writer = 0;  ///< this and the next two are the gate's
  std::uint64_t refused_session = 0;
  std::uint64_t refused_sequence = 0;
  std::uint64_t clamped_force = 0;  ///< commands
  std::uint64_t clamped_torque = 0;
  std::uint64_t clamped_slew = 0;  ///< periods; in a certified loop none
  std::uint64_t faded = 0;         ///< fades begun
  std::uint64_t clock_faults = 0;  ///< periods in which the time did not advance

  std::uint64_t refused() const noexcept {
    return refused_not_finite + refused_stale + refused_writer + refused_session + refused_sequence;
  }
  std::uint64_t clamped() const noexcept { return clamped_force + clamped_torque + clamped_slew; }
};

/// Has no clock and no thread; the caller gives the time. Call `pass` once per period, with the
/// newest command if one was received. All functions except the constructor are real-time safe.
///
/// The output follows fraction * command within the slew limit. The fraction rises from 0 to 1 over
/// the ramp while commands arrive, so a start in contact causes no step. It falls to 0 over the
/// fade if the last command is older than `hold_periods` or its valid-until. A command received
/// during the fade continues from the current fraction.
class ForceGuard {
 public:
  /// Throws as GuardConfig::validate does.
  explicit ForceGuard(const GuardConfig& config);

  /// Returns the wrench for the device. `now_ns`: device clock. A time that does not advance counts
  /// as one nominal period, so a faulty clock cannot hold a force. A gap opens the slew limit by
  /// the hold time at most. A refused command counts as none: the previous one is repeated, then
  /// fades.
  Wrench pass(const std::optional<GuardInput>& command, std::int64_t now_ns) noexcept;

  /// Adds a refusal of the gate to the counts.
  void count(GateVerdict verdict) noexcept;

  /// Zero, at once and until `restart`; commands are ignored.
  void stop() noexcept;
  /// As new, but for the counts: the next command ramps in over `start_ramp_s`.
  void restart() noexcept;

  const GuardConfig& config() const noexcept { return config_; }
  const GuardCounts& counts() const noexcept { return counts_; }
  double fraction() const noexcept;  ///< of the command that may pass now, [0, 1]
  bool ramping() const noexcept { return phase_ == Phase::kLive && fraction_ < 1.0; }
  bool fading() const noexcept { return phase_ == Phase::kFading; }
  bool stopped() const noexcept { return phase_ == Phase::kStopped; }

 private:
  enum class Phase : std::uint8_t { kIdle, kLive, kFading, kStopped };
  std::int64_t elapsed_ns(std::int64_t now_ns) noexcept;
  bool age(std::int64_t dt_ns,
           std::int64_t now_ns) noexcept;  // true: faded out in this very period
  void raise(double dt_s) noexcept;
  void accept(const GuardInput& command, std::int64_t now_ns) noexcept;
  void lead(double dt_s) noexcept;

  GuardConfig config_;
  std::int64_t period_ns_, hold_ns_;
  GuardCounts counts_;
  Phase phase_ = Phase::kIdle;
  std::optional<std::int64_t> last_ns_;
  std::int64_t age_ns_ =
      0;  // of the command, by elapsed time rather than by stamps: the clock may jump
  std::int64_t valid_until_ns_ = 0;
  Wrench command_, output_;
  Wrench fade_from_;       // the output when the fade began
  double fraction_ = 0.0;  // while fading: the fraction when the fade began
  double fade_ = 0.0;      // 1 to 0 while fading
  bool ramped_once_ = false;
};

}  // namespace voxtouch::devices
