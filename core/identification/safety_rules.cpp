#include "core/identification/safety_rules.hpp"

#include <algorithm>
#include <cmath>

namespace voxtouch::identification {
namespace {

constexpr int kMostInvalid = 3;
constexpr double kSpeedWindowS = 4e-3;
constexpr double kFollowingErrorM = 9e-3;
constexpr double kFollowingErrorSteps = 20.0;
constexpr double kPathWithoutIncrementM = 3e-3;
constexpr double kSpeedGain = 0.25;  // [m/s]

}  // namespace

void SafetyRules::start(const AxisLimits& limits) noexcept {
  *this = {};
  limits_ = limits;
}

std::optional<Outcome> SafetyRules::check(double time_s, double position_m, double step) noexcept {
  const bool valid =
      std::isfinite(time_s) && std::isfinite(position_m) && (!started_ || time_s > last_time_);
  if (!valid) {
    if (++invalid_ >= kMostInvalid)
      return Outcome::kInvalidSamples;
    return std::nullopt;
  }
  invalid_ = 0;
  if (!started_) {
    started_ = true;
    origin_ = position_m;
    reference_ = last_position_ = position_m;
  }
  last_time_ = time_s;
  if (std::abs(position_m - origin_) > limits_.box_m)
    return Outcome::kLeftBounds;
  points_[count_++ % kKept] = {time_s, position_m};
  // The newest sample that is old enough; a jump of two steps is no speed.
  const double window = std::max(kSpeedWindowS, 2.5 * limits_.period_s);
  for (std::size_t back = 1; back < std::min(count_, kKept); ++back) {
    const Point& p = points_[(count_ - 1 - back) % kKept];
    const double dt = time_s - p.time_s;
    if (dt < window && back + 1 < std::min(count_, kKept))
      continue;
    if (dt > 0.0 && std::abs(position_m - p.position_m) - 2.0 * step > limits_.speed_m_per_s * dt)
      return Outcome::kLeftBounds;
    break;
  }
  return std::nullopt;
}

void SafetyRules::restart_reference(double reference_m) noexcept {
  reference_ = reference_m;
  path_without_increment_ = 0.0;
}

std::optional<Outcome> SafetyRules::check_reference(double reference_m, double position_m,
                                                    double step) noexcept {
  if (std::abs(reference_m - position_m) > kFollowingErrorM + kFollowingErrorSteps * step)
    return Outcome::kFollowingError;
  path_without_increment_ += std::abs(reference_m - reference_);
  reference_ = reference_m;
  if (position_m != last_position_)
    path_without_increment_ = 0.0;
  last_position_ = position_m;
  if (path_without_increment_ > kPathWithoutIncrementM)
    return Outcome::kEncoderStuck;
  return std::nullopt;
}

double force_that_mass_takes(const AxisModel& m, double period_s) noexcept {
  const double reaction = 2.4 * period_s + m.delay_s + 2e-3;
  return m.coulomb_n + std::abs(m.bias_n) + m.mass_kg * kSpeedGain / reaction;
}

}  // namespace voxtouch::identification
