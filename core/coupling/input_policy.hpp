#pragma once
/// What is done with a sample before a law sees it: mend the period, refuse what is not a number,
/// fade in what would otherwise be a step. Once for whichever law runs.
#include <cstdint>

#include "core/coupling/coupling.hpp"

namespace voxtouch::coupling {

/// Periods within [T/5, 5T] are used as measured; beyond 10 T the loop has stood still.
inline constexpr double kPeriodBand = 5.0, kGapPeriods = 10.0;
/// A component beyond this [N, Nm, N/m] is no force but a fault, and is treated as NaN is.
inline constexpr double kLargestInput = 1e12;

/// What the policy finds about one sample.
struct PolicedSample {
  double dt_s = 0;    ///< the period as measured, within the band, or the nominal one
  double weight = 1;  ///< fraction of the contact in what the law is given; the rest belongs to the
                      ///< force of the start
  bool good = false;  ///< the input is made of numbers; else the last good one is repeated
  bool lost =
      false;  ///< none was good for kGapPeriods: from now on the contact is none, until one is
  bool gap = false;  ///< the loop stood still, or good inputs have ended or come back: start again
                     ///< at the force given last
};

/// Whether contact, bound and stiffness matrix are numbers that a law can take. The pose is not
/// asked. Real-time safe.
bool usable(const CouplingInput& input) noexcept;

/// Real-time safe; one per coupling. An input that is not usable is replaced by the last good one
/// for at most kGapPeriods periods: a force that no longer follows the hand can be pumped for
/// energy. Then, as after a gap of time, the coupling starts again at the force given last and
/// fades, first to no contact and, when good inputs are back, to theirs.
class InputPolicy {
 public:
  /// `nominal_s`: the sample time [s]; `ramp_s`: how long an input is faded in [s]. Both above 0.
  InputPolicy(double nominal_s, double ramp_s) noexcept : nominal_s_(nominal_s), ramp_s_(ramp_s) {}

  /// One sample, `dt_s` [s] after the last; call once a sample. What is wrong with either is
  /// counted, and answered as above.
  PolicedSample apply(const CouplingInput& input, double dt_s) noexcept;
  /// The next samples are faded in from a force that is given already, or, where there is none,
  /// only if the first good one is in contact: a contact that begins later begins at depth zero by
  /// itself, and fading it would let the tool sink below the layer that pushes.
  void restart(bool gives_force) noexcept;

  std::uint64_t faults() const noexcept { return faults_; }  ///< bad periods and bad inputs so far

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
