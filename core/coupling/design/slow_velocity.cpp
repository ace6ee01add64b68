#include "core/coupling/design/slow_velocity.hpp"

#include <array>

#include "core/coupling/design/min_damping_ratio.hpp"

namespace voxtouch::coupling::design {
namespace {

/// Candidates [Hz], the slowest first; all below 50 Hz, the slowest velocity that is certified in
/// full.
constexpr std::array kSlowHz{8.0, 10.0, 12.5, 16.0, 20.0, 25.0, 32.0};

}  // namespace

double slow_ratio(const AxisProblem& translation, const CouplingSpec& spec) {
  return spec.velocity_band_m_per_s <= kRounding * step_speed(translation, velocity_of(spec))
             ? translation.large_swing
             : 1.0;
}

bool holds_on_slow_velocity(const AxisProblem& translation, const CouplingSpec& spec,
                            const DisplayedStiffness& displayed) {
  if (!damps_on_slow_velocity(spec))
    return true;
  if (spec.kind == "spring_damper")
    return false;
  LoopController law = controller_of(spec, translation, 0.0);
  law.use({spec.slow_velocity_hz, 0});
  const double fraction = slow_ratio(translation, spec),
               needed = fraction * translation.margin * displayed.coupling * displayed.displayed;
  if (critical_case(translation, law, needed).stiffness < needed)
    return false;
  AxisProblem gentler = translation;
  for (DesignCase& one : gentler.cases)
    one.least_damping_ratio *= fraction;
  return meets_min_damping(gentler, law, displayed.displayed);
}

void choose_slow_velocity(const AxisProblem& translation, const DisplayedStiffness& displayed,
                          CouplingSpec& spec) {
  const VelocityEstimate velocity = velocity_of(spec);
  const double band = step_speed(translation, velocity);
  if (spec.injected_damping_ns_per_m * band <= kRounding * kQuietForceN)
    return;
  CouplingSpec with = spec;
  with.velocity_band_m_per_s = band;
  for (const double hz : kSlowHz) {
    with.slow_velocity_hz = hz;
    if (step_speed(translation, {hz, 0}) >= band)
      return;
    if (holds_on_slow_velocity(translation, with, displayed)) {
      spec = with;
      return;
    }
  }
}

}  // namespace voxtouch::coupling::design
