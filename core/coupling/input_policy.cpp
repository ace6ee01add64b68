#include "core/coupling/input_policy.hpp"

#include <cmath>
#include <utility>

namespace voxtouch::coupling {
namespace {

bool usable(const Vec3& v) noexcept {
  return v.allFinite() && v.cwiseAbs().maxCoeff() <= kLargestInput;
}

}  // namespace

bool usable(const CouplingInput& in) noexcept {
  return usable(in.contact.force) && usable(in.contact.torque) &&
         in.contact_stiffness_n_per_m >= 0.0 && in.contact_stiffness_n_per_m <= kLargestInput &&
         in.contact_stiffness.allFinite() &&
         in.contact_stiffness.cwiseAbs().maxCoeff() <= kLargestInput;
}

void InputPolicy::restart(bool gives_force) noexcept {
  start_ = gives_force ? Start::kFade : Start::kFadeIfInContact;
  in_contact_ = false;
  repeated_s_ = 0.0, lost_ = false;
}

PolicedSample InputPolicy::apply(const CouplingInput& input, double dt_s) noexcept {
  PolicedSample sample;
  const bool good_period =
      dt_s >= nominal_s_ / kPeriodBand && dt_s <= nominal_s_ * kPeriodBand;  // false for NaN
  sample.dt_s = good_period ? dt_s : nominal_s_;
  sample.valid = usable(input);
  faults_ += static_cast<std::uint64_t>(!good_period) + static_cast<std::uint64_t>(!sample.valid);
  sample.gap = begins_again(sample) || dt_s > nominal_s_ * kGapPeriods;
  sample.lost = lost_;
  if (sample.gap)
    start_ = Start::kFade;
  if (sample.valid)
    in_contact_ = !input.contact.zero() || input.contact_stiffness_n_per_m > 0.0;
  if (sample.lost)
    in_contact_ = false;
  sample.weight = weight_after(sample);
  return sample;
}

/// Returns true when valid inputs have been missing for too long, and when they return after that.
bool InputPolicy::begins_again(const PolicedSample& sample) noexcept {
  if (sample.valid) {
    repeated_s_ = 0.0;
    return std::exchange(lost_, false);
  }
  repeated_s_ += sample.dt_s;
  if (lost_ || start_ != Start::kRunning || repeated_s_ <= nominal_s_ * kGapPeriods)
    return false;
  return lost_ = true;
}

double InputPolicy::weight_after(const PolicedSample& sample) noexcept {
  if (start_ != Start::kRunning) {
    if (start_ == Start::kFade || (sample.valid && in_contact_))
      elapsed_s_ = 0.0;
    else if (sample.valid)
      elapsed_s_ = ramp_s_;  // started in free space: no fade needed
    else
      return 0.0;  // no valid input so far
    start_ = Start::kRunning;
  }
  if (elapsed_s_ >= ramp_s_)
    return 1.0;
  elapsed_s_ += sample.dt_s;
  return elapsed_s_ < ramp_s_ ? elapsed_s_ / ramp_s_ : 1.0;
}

}  // namespace voxtouch::coupling
