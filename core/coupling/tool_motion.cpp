#include "core/coupling/tool_motion.hpp"

#include <cmath>
#include <numbers>

#include "core/coupling/input_policy.hpp"
#include "core/types/rotation_vector.hpp"

namespace voxtouch::coupling {
namespace {

/// How far a quaternion's norm may be from one [F7], and a velocity component that is none: denormal numbers are slow.
constexpr double kNormBand = 1e-3, kRest = 1e-30;

void blend(Vec3& mean, double old_share, const Vec3& sample) noexcept {
  mean = old_share * mean + (1.0 - old_share) * sample;
  for (double& x : mean)
    if (std::abs(x) < kRest) x = 0.0;
}

}  // namespace

ToolMotion::ToolMotion(double nominal_s, double velocity_filter_hz, const ToolSpeedLimits& limits) noexcept
    : nominal_s_(nominal_s), limits_(limits) {
  set_filter(velocity_filter_hz);
}

void ToolMotion::set_filter(double velocity_filter_hz) noexcept {
  cutoff_rad_per_s_ = 2.0 * std::numbers::pi * velocity_filter_hz;
}

void ToolMotion::forget() noexcept {
  anchored_ = false;
  elapsed_s_ = 0.0;
  step_ = {};
  velocity_ = {};
}

const ToolStep& ToolMotion::step(const Pose& tool, double dt_s) noexcept {
  step_ = {};
  const double gap_s = kGapPeriods * nominal_s_;
  const bool gap = dt_s > gap_s;
  elapsed_s_ += dt_s >= nominal_s_ / kPeriodBand && !gap ? dt_s : nominal_s_;
  if (gap || elapsed_s_ > gap_s) forget();
  Quat orientation = tool.orientation;
  const bool good = tool.position.allFinite() && tool.position.cwiseAbs().maxCoeff() <= kLargestInput &&
                    normalise_within(orientation, 1.0 - kNormBand, 1.0 + kNormBand);
  if (good) move_to(tool.position, orientation);
  return step_;
}

void ToolMotion::move_to(const Vec3& position, const Quat& orientation) noexcept {
  if (anchored_) {
    const Vec3 shift = position - last_.position, turn = rotation_vector(last_.orientation, orientation);
    if (shift.norm() <= limits_.linear_m_per_s * elapsed_s_ && turn.norm() <= limits_.angular_rad_per_s * elapsed_s_) {
      step_ = {true, shift, turn};
      const double old_share = std::exp(-cutoff_rad_per_s_ * elapsed_s_);
      blend(velocity_.linear, old_share, shift / elapsed_s_);
      blend(velocity_.angular, old_share, turn / elapsed_s_);
    } else {
      ++jumps_;
      velocity_ = {};
    }
  }
  last_ = {position, orientation};
  anchored_ = true;
  elapsed_s_ = 0.0;
}

}  // namespace voxtouch::coupling
