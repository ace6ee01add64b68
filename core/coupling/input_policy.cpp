#include "core/coupling/input_policy.hpp"

#include <utility>

#include "core/types/clamp.hpp"

namespace voxtouch {
namespace {

bool usable(const Vec3& v) noexcept { return v.allFinite() && v.cwiseAbs().maxCoeff() <= kLargestInput; }

}  // namespace

bool usable(const CouplingInput& in) noexcept {
  return usable(in.contact.force) && usable(in.contact.torque) && in.contact_stiffness_n_per_m >= 0.0 &&
         in.contact_stiffness_n_per_m <= kLargestInput && in.contact_stiffness.allFinite() &&
         in.contact_stiffness.cwiseAbs().maxCoeff() <= kLargestInput;
}

Wrench InputPolicy::restart(const Wrench& held) noexcept {
  Wrench start = held.finite() ? held : Wrench{};
  clamp_wrench(start, limits_.max_force_n, limits_.max_torque_nm);
  start_ = start.zero() ? Start::kFadeIfInContact : Start::kFade;
  last_ = {};
  held_s_ = 0.0, lost_ = false;
  return start;
}

PolicedInput InputPolicy::take(const CouplingInput& input, double dt_s, double gain) noexcept {
  status_ = {};
  PolicedInput out;
  const bool good_period = dt_s >= nominal_s_ / kPeriodBand && dt_s <= nominal_s_ * kPeriodBand;  // false for NaN
  out.dt_s = good_period ? dt_s : nominal_s_;
  if (!good_period) ++faults_;
  const bool good_input = usable(input);
  out.gap = dt_s > nominal_s_ * kGapPeriods;
  out.gap |= hold_or_lose(good_input, out.dt_s);
  if (out.gap) start_ = Start::kFade;

  if (good_input) {
    last_ = input;
  } else {
    ++faults_;
    status_.held_input = true;
  }
  out.contact = last_.contact;
  out.stiffness_n_per_m = last_.contact_stiffness_n_per_m;
  if (gain > 0.0) {
    status_.clamped |= clamp_wrench(out.contact, limits_.max_force_n / gain, limits_.max_torque_nm / gain).any();
  } else {
    out.contact = {};  // gives zero anyhow, and an uncut input must not wait in the law's state for the gain to come back
  }
  out.weight = weight_after(out.dt_s, good_input, !last_.contact.zero() || out.stiffness_n_per_m > 0.0);
  status_.ramping = out.weight < 1.0;
  return out;
}

bool InputPolicy::hold_or_lose(bool good, double dt_s) noexcept {
  if (good) {
    held_s_ = 0.0;
    return std::exchange(lost_, false);
  }
  held_s_ += dt_s;
  if (lost_ || start_ != Start::kRunning || held_s_ <= nominal_s_ * kGapPeriods) return false;
  last_ = {};
  return lost_ = true;
}

double InputPolicy::weight_after(double dt_s, bool usable, bool in_contact) noexcept {
  if (start_ != Start::kRunning) {
    if (start_ == Start::kFade || (usable && in_contact)) elapsed_s_ = 0.0;
    else if (usable) elapsed_s_ = ramp_s_;  // started in free space: nothing to fade
    else return 0.0;                        // nothing known yet
    start_ = Start::kRunning;
  }
  if (elapsed_s_ >= ramp_s_) return 1.0;
  elapsed_s_ += dt_s;
  return elapsed_s_ < ramp_s_ ? elapsed_s_ / ramp_s_ : 1.0;
}

}  // namespace voxtouch
