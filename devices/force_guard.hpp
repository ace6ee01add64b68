#pragma once
/// The last check before any device: the force is finite, within the limits, and fades when
/// commands stop.
#include <cstdint>
#include <optional>

#include "devices/command_gate.hpp"
#include "devices/driver.hpp"

namespace voxtouch::devices {

/// Limits of the guard. The slew limits allow its own fades; infinity: no limit.
struct GuardConfig {
  double period_s = 1e-3;                 ///< [1e-6, 1]
  double max_force_n = 0.0;               ///< (0, 1e9]
  double max_torque_nm = 0.0;             ///< [0, 1e9]; 0: the output has no torque
  double max_force_rate_n_per_s = 0.0;    ///< derive_slew_limits; at least max_force_n / fade_s
  double max_torque_rate_nm_per_s = 0.0;  ///< likewise; at least max_torque_nm / fade_s
  double hold_periods = 3.0;              ///< a command is repeated for this many, [1, 1000]
  double fade_s = 0.02;                   ///< duration of the fade that follows, (0, 1]
  double start_ramp_s = 0.5;              ///< ramp to full force at the start, [0, 10]
  double return_ramp_s = kReturnRampS;    ///< after a fade, once the start's ramp is over; [0, 10]

  /// Throws std::runtime_error that names field, value and rule.
  void validate() const;
};

/// Limits of `device`, with the default times above. Real-time safe.
GuardConfig guard_config(const DeviceDescription& device) noexcept;

/// A new command, in frame D.
struct GuardInput {
  Wrench wrench;
  std::int64_t valid_until_ns = 0;  ///< on the device's clock; later the command fades
};

struct GuardCounts {
  std::uint64_t passed = 0;  ///< accepted commands, including clamped ones
  std::uint64_t refused_not_finite = 0;
  std::uint64_t refused_stale = 0;   ///< expired on arrival
  std::uint64_t refused_writer = 0;  ///< this and the next two: by CommandGate
  std::uint64_t refused_session = 0;
  std::uint64_t refused_sequence = 0;
  std::uint64_t clamped_force = 0;  ///< commands
  std::uint64_t clamped_torque = 0;
  std::uint64_t clamped_slew = 0;  ///< periods; 0 in a certified loop
  std::uint64_t faded = 0;         ///< fades begun
  std::uint64_t clock_faults = 0;  ///< periods in which the time did not advance

  std::uint64_t refused() const noexcept {
    return refused_not_finite + refused_stale + refused_writer + refused_session + refused_sequence;
  }
  std::uint64_t clamped() const noexcept { return clamped_force + clamped_torque + clamped_slew; }
};

/// Limits and fades the command, in frame D. It has no clock and no thread. Call `pass` once per
/// period, with the newest command if one was received. All functions except the constructor are
/// real-time safe.
///
/// The output follows fraction * command within the slew limit. While commands arrive, the fraction
/// rises from 0 to 1 over the ramp, so a start in contact causes no step. If the last command is
/// older than `hold_periods` or has expired, the fraction falls to 0 over `fade_s`. A command
/// received during the fade continues from the present fraction.
class ForceGuard {
 public:
  /// Throws like GuardConfig::validate.
  explicit ForceGuard(const GuardConfig& config);

  /// Returns the wrench for the device. `now_ns`: device clock; a time that does not advance counts
  /// as one nominal period, so that a faulty clock cannot sustain a force. After a gap, the slew
  /// limit covers at most `hold_periods`. A refused command counts as none.
  Wrench pass(const std::optional<GuardInput>& command, std::int64_t now_ns) noexcept;

  /// Adds a refusal of the gate to the counts.
  void count(GateVerdict verdict) noexcept;

  /// Zero at once; commands are ignored until `restart`.
  void stop() noexcept;
  /// Clears all except the counts. The next command ramps in over `start_ramp_s`.
  void restart() noexcept;

  const GuardConfig& config() const noexcept { return config_; }
  const GuardCounts& counts() const noexcept { return counts_; }
  double fraction() const noexcept;  ///< present factor on the command, [0, 1]
  bool ramping() const noexcept { return phase_ == Phase::kLive && fraction_ < 1.0; }
  bool fading() const noexcept { return phase_ == Phase::kFading; }
  bool stopped() const noexcept { return phase_ == Phase::kStopped; }

 private:
  enum class Phase : std::uint8_t { kIdle, kLive, kFading, kStopped };
  std::int64_t elapsed_ns(std::int64_t now_ns) noexcept;
  bool update_phase(std::int64_t dt_ns,
                    std::int64_t now_ns) noexcept;  // true: the fade ended in this period
  void advance_ramp(double dt_s) noexcept;
  void accept(const GuardInput& command, std::int64_t now_ns) noexcept;
  void update_output(double dt_s) noexcept;

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
