#include "core/coupling/design/loop_checks.hpp"

#include <fmt/core.h>

#include <cmath>
#include <stdexcept>

namespace voxtouch::coupling::design {
namespace {

/// Decay of the velocity, and square of the resonance, per period: far beyond any device, and still a matrix exponential.
constexpr double kFastestPlant = 1e9;

void require(bool kept, const char* field, double value, const char* rule) {
  if (!kept) throw std::invalid_argument(fmt::format("The loop's {} is {}; it must be {}.", field, value, rule));
}

}  // namespace

void require_finite(const char* field, double value) { require(std::isfinite(value), field, value, "finite"); }

void require_not_negative(const char* field, double value) {
  require(value >= 0.0 && std::isfinite(value), field, value, "finite and 0 or above");
}

void require_positive(const char* field, double value) {
  require(value > 0.0 && std::isfinite(value), field, value, "finite and above 0");
}

void require_loop(const LoopPlant& p) {
  require_not_negative("mass", p.mass);
  require_not_negative("hand_mass", p.hand_mass);
  require_positive("mass + hand_mass", p.mass + p.hand_mass);
  require_not_negative("damping", p.damping);
  require_not_negative("hand_damping", p.hand_damping);
  require_not_negative("hand_stiffness", p.hand_stiffness);
  require_positive("period_s", p.period_s);
  require_not_negative("delay_s", p.delay_s);
  require_not_negative("effort_lag_s", p.effort_lag_s);
  const double per_mass = p.period_s / (p.mass + p.hand_mass);
  require((p.damping + p.hand_damping) * per_mass <= kFastestPlant, "damping", p.damping + p.hand_damping,
          "at most 1e9 masses per period");
  require(p.hand_stiffness * p.period_s * per_mass <= kFastestPlant, "hand_stiffness", p.hand_stiffness,
          "at most 1e9 masses per period squared");
  require(p.delay_s <= kMaxDelayPeriods * p.period_s, "delay_s", p.delay_s, "at most 200 periods");
}

void require_loop(const LoopController& c) {
  if (c.law == LoopController::Law::kShapingFilter) {
    require_positive("w0_rad_per_s", c.w0_rad_per_s);
    require_positive("damping_ratio", c.damping_ratio);
  }
  if (c.law == LoopController::Law::kSpringDamper) {
    require_not_negative("spring-damper's stiffness", c.stiffness);
    require_not_negative("spring-damper's damping", c.damping);
  } else {
    require_finite("gain", c.gain);
  }
  require_not_negative("injected_damping", c.injected_damping);
  require_not_negative("velocity_filter_rad_per_s", c.velocity_filter_rad_per_s);
}

}  // namespace voxtouch::coupling::design
