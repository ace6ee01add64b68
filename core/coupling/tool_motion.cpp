#include "core/coupling/tool_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/coupling/input_policy.hpp"
#include "core/types/rotation_vector.hpp"

namespace voxtouch::coupling {
namespace {

/// Tolerance of a quaternion's norm. Velocity components below kRest count as zero, because
/// denormal numbers are slow.
constexpr double kNormBand = 1e-3, kRest = 1e-30;

void blend(Vec3& mean, double old_weight, const Vec3& sample) noexcept {
  mean = old_weight * mean + (1.0 - old_weight) * sample;
  for (double& x : mean)
    if (std::abs(x) < kRest)
      x = 0.0;
}

}  // namespace

ToolMotion::ToolMotion(double nominal_s, double velocity_filter_hz, const ToolSpeedLimits& limits,
                       int velocity_window) noexcept
    : nominal_s_(nominal_s),
      limits_(limits) {
  set_filter(velocity_filter_hz, velocity_window);
  forget_velocity();
}

void ToolMotion::set_filter(double velocity_filter_hz, int velocity_window) noexcept {
  cutoff_rad_per_s_ = 2.0 * std::numbers::pi * velocity_filter_hz;
  window_ = velocity_window;
}

void ToolMotion::set_slow(double slow_velocity_hz, double band_m_per_s) noexcept {
  slow_rad_per_s_ = 2.0 * std::numbers::pi * slow_velocity_hz;
  band_m_per_s_ = band_m_per_s;
}

void ToolMotion::clear() noexcept {
  anchored_ = false;
  elapsed_s_ = 0.0;
  step_ = {};
  forget_velocity();
}

/// Fills the estimates with those of a tool at rest.
void ToolMotion::forget_velocity() noexcept {
  fast_ = velocity_ = {};
  slow_.setZero();
  displacements_.fill({{}, nominal_s_});
  known_ = 0;
}

void ToolMotion::remember(const Vec3& shift, const Vec3& rotation) noexcept {
  const int size = static_cast<int>(displacements_.size()),
            parts = std::clamp(static_cast<int>(std::lround(elapsed_s_ / nominal_s_)), 1, size);
  for (int i = 0; i < parts; ++i) {
    newest_ = (newest_ + 1) % size;
    displacements_[newest_] = {{shift / parts, rotation / parts}, elapsed_s_ / parts};
  }
  known_ = std::min(known_ + parts, size);
}

/// Displacement over time of `count` steps, the newest of them `from` steps ago.
Twist ToolMotion::quotient(int from, int count) const noexcept {
  const int size = static_cast<int>(displacements_.size());
  Displacement sum{{}, 0.0};
  for (int ago = from; ago < from + count; ++ago) {
    const Displacement& one = displacements_[(newest_ + size - ago) % size];
    sum.displacement.linear += one.displacement.linear,
        sum.displacement.angular += one.displacement.angular, sum.time_s += one.time_s;
  }
  return {sum.displacement.linear / sum.time_s, sum.displacement.angular / sum.time_s};
}

Twist ToolMotion::velocity_of_window() const noexcept {
  const Twist last = quotient(0, window_last(window_));
  if (known_ < window_span(window_))
    return last;
  const Twist before = quotient(window_last(window_), window_before(window_));
  return {last.linear + kWindowLead * (last.linear - before.linear),
          last.angular + kWindowLead * (last.angular - before.angular)};
}

void ToolMotion::estimate_velocity(const Vec3& shift, const Vec3& rotation) noexcept {
  if (window_ > 0) {
    fast_ = velocity_of_window();
  } else {
    const double old_weight = std::exp(-cutoff_rad_per_s_ * elapsed_s_);
    blend(fast_.linear, old_weight, shift / elapsed_s_);
    blend(fast_.angular, old_weight, rotation / elapsed_s_);
  }
  velocity_ = fast_;
  if (!(slow_rad_per_s_ > 0.0 && band_m_per_s_ > 0.0)) {
    slow_ = fast_.linear;
    return;
  }
  blend(slow_, std::exp(-slow_rad_per_s_ * elapsed_s_), shift / elapsed_s_);
  velocity_.linear += (slow_ - fast_.linear).cwiseMax(-band_m_per_s_).cwiseMin(band_m_per_s_);
}

const ToolStep& ToolMotion::step(const Pose& tool, double dt_s) noexcept {
  step_ = {};
  const double gap_s = kGapPeriods * nominal_s_;
  const bool gap = dt_s > gap_s;
  elapsed_s_ += dt_s >= nominal_s_ / kPeriodBand && !gap ? dt_s : nominal_s_;
  if (gap || elapsed_s_ > gap_s)
    clear();
  Quat orientation = tool.orientation;
  const bool good = tool.position.allFinite() &&
                    tool.position.cwiseAbs().maxCoeff() <= kLargestInput &&
                    normalise_within(orientation, 1.0 - kNormBand, 1.0 + kNormBand);
  if (good)
    move_to(tool.position, orientation);
  return step_;
}

void ToolMotion::move_to(const Vec3& position, const Quat& orientation) noexcept {
  if (anchored_) {
    const Vec3 shift = position - last_.position,
               rotation = rotation_vector(last_.orientation, orientation);
    if (shift.norm() <= limits_.linear_m_per_s * elapsed_s_ &&
        rotation.norm() <= limits_.angular_rad_per_s * elapsed_s_) {
      step_ = {true, shift, rotation};
      remember(shift, rotation);
      estimate_velocity(shift, rotation);
    } else {
      ++jumps_;
      forget_velocity();
    }
  }
  last_ = {position, orientation};
  anchored_ = true;
  elapsed_s_ = 0.0;
}

}  // namespace voxtouch::coupling
