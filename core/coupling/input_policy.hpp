#pragma once
/// Prepares each sample for a coupling law: corrects the period, rejects invalid numbers and fades
/// in steps. Common to all laws.
#include <cstdint>

#include "core/coupling/coupling.hpp"

namespace voxtouch::coupling {

/// Periods within [T/5, 5T] are used as measured. A gap of more than 10 T means that the loop was
/// suspended.
inline constexpr double kPeriodBand = 5.0, kGapPeriods = 10.0;
/// A larger component [N, Nm, N/m] is a fault, and is handled like NaN.
inline constexpr double kLargestInput = 1e12;

/// Result of the policy for one sample.
struct PolicedSample {
  double dt_s = 0;     ///< the measured period if it is within the band, else the nominal one
  double weight = 1;   ///< fraction of the contact in the law's input; the rest is the start force
  bool valid = false;  ///< the input is valid; else the last valid one is repeated
  /// No valid input for kGapPeriods: the contact is zero until the next valid one.
  bool lost = false;
  /// The loop was suspended, or valid inputs have ended or returned: restart at the last force.
  bool gap = false;
};

/// Whether contact, stiffness bound and stiffness matrix are valid. The pose is not checked.
/// Real-time safe.
bool usable(const CouplingInput& input) noexcept;

/// Input policy of one coupling. Real-time safe.
///
/// An invalid input is replaced by the last valid one for at most kGapPeriods periods, because a
/// force that does not follow the operator can generate energy. Then the coupling restarts at the
/// last force, as after a gap in time, and fades to zero contact. When valid inputs return, it
/// fades to them.
class InputPolicy {
 public:
  /// `nominal_s`: sample time [s]. `ramp_s`: duration of the fade-in [s]. Both > 0.
  InputPolicy(double nominal_s, double ramp_s) noexcept : nominal_s_(nominal_s), ramp_s_(ramp_s) {}

  /// Processes one sample, `dt_s` [s] after the last; call it once per sample. Faults of input or
  /// period are counted.
  PolicedSample apply(const CouplingInput& input, double dt_s) noexcept;
  /// Fades in the next samples from the present force. Without a present force, it fades only if
  /// the first valid sample is in contact. A contact that begins later starts at depth zero; fading
  /// it would let the tool sink below the force layer.
  void restart(bool gives_force) noexcept;

  /// Number of invalid periods and inputs.
  std::uint64_t faults() const noexcept { return faults_; }

 private:
  enum class Start : std::uint8_t { kRunning, kFadeIfInContact, kFade };
  bool begins_again(const PolicedSample& sample) noexcept;
  double weight_after(const PolicedSample& sample) noexcept;

  double nominal_s_, ramp_s_, elapsed_s_ = 0, repeated_s_ = 0;
  bool lost_ = false, in_contact_ = false;
  Start start_ = Start::kFadeIfInContact;
  std::uint64_t faults_ = 0;
};

}  // namespace voxtouch::coupling
