#pragma once
/// What every coupling does with a sample before its own law sees it: mend the period, refuse what is not a number, cut what
/// the device cannot give, fade in what would otherwise be a step.
#include <cstdint>

#include "core/coupling/coupling.hpp"

namespace voxtouch {

/// Periods within [T/5, 5T] are used as measured; beyond 10 T the loop has stood still.
inline constexpr double kPeriodBand = 5.0, kGapPeriods = 10.0;
/// A component beyond this [N, Nm, N/m] is no force but a fault, and is treated as NaN is.
inline constexpr double kLargestInput = 1e12;

/// A sample that a law can take as it is.
struct PolicedInput {
  Wrench contact;                 ///< finite, within the limits
  double stiffness_n_per_m = 0;   ///< finite, >= 0
  double dt_s = 0;                ///< within the band
  double weight = 1;              ///< share of `contact`; the rest belongs to the force that was held at the start
  bool gap = false;               ///< the loop stood still: start again at the force given last
};

/// Whether contact, bound and stiffness matrix are numbers that a law can take. The pose is not asked. Real-time safe.
bool usable(const CouplingInput& input) noexcept;

/// Real-time safe; one per coupling. An input that is not usable is replaced by the last good one for at most kGapPeriods
/// periods: a force that no longer follows the hand can be pumped for energy. Then, as after a gap of time, the coupling starts
/// again at the force given last and fades, first to no contact and, when good inputs are back, to theirs.
class InputPolicy {
 public:
  InputPolicy(const CouplingLimits& limits, double nominal_s, double ramp_s) noexcept
      : limits_(limits), nominal_s_(nominal_s), ramp_s_(ramp_s) {}

  /// `gain` is what the law will multiply by: the input is cut at limit / gain, so that the law's state never winds up on a
  /// peak that the device cannot give.
  PolicedInput take(const CouplingInput& input, double dt_s, double gain) noexcept;
  /// Forgets the last input; the next samples are faded in from `held`, or, where that is zero, only if the first good one is
  /// in contact. Gives back `held` as far as the limits allow; zero where it is not finite.
  Wrench restart(const Wrench& held) noexcept;

  std::uint64_t faults() const noexcept { return faults_; }  ///< bad periods and bad inputs
  const CouplingStatus& status() const noexcept { return status_; }
  double nominal_period_s() const noexcept { return nominal_s_; }

 private:
  enum class Start : std::uint8_t { kRunning, kFadeIfInContact, kFade };
  bool hold_or_lose(bool good, double dt_s) noexcept;
  double weight_after(double dt_s, bool usable, bool in_contact) noexcept;

  CouplingLimits limits_;
  double nominal_s_, ramp_s_, elapsed_s_ = 0, held_s_ = 0;
  bool lost_ = false;
  Start start_ = Start::kFadeIfInContact;
  CouplingInput last_;
  CouplingStatus status_;
  std::uint64_t faults_ = 0;
};

}  // namespace voxtouch
