#include <cmath>
#include <limits>
#include <numbers>

#include "core/coupling/design/design_axis.hpp"
#include "core/coupling/design/first_crossing.hpp"
#include "core/coupling/design/loop_response.hpp"
#include "core/coupling/design/sampled_loop.hpp"

namespace voxtouch::coupling::design {
namespace {

using Law = LoopController::Law;

double mass_of(const LoopPlant& p) { return p.mass + p.hand_mass; }
double damping_of(const LoopPlant& p) { return p.damping + p.hand_damping; }
bool swings_undamped(const LoopPlant& p) { return p.hand_stiffness > 0.0 && damping_of(p) == 0.0; }

/// The hand's resonance on the sampled circle [rad per sample], folded if it exceeds half the
/// sample rate.
double resonance_of(const LoopPlant& p) {
  return std::abs(std::remainder(std::sqrt(p.hand_stiffness / mass_of(p)) * p.period_s,
                                 2.0 * std::numbers::pi));
}

/// The resonance of an undamped hand lies on the unit circle, where L passes through infinity.
/// Moved inside by this fraction of critical damping, L passes on the side of the eigenvalue that
/// is stable. The function moves_inside checks whether it is stable for small gains.
LoopPlant with_regularising_damping(LoopPlant p) {
  constexpr double kRegularisingRatio = 1e-9;
  if (swings_undamped(p))
    p.hand_damping = 2.0 * kRegularisingRatio * std::sqrt(p.hand_stiffness * mass_of(p));
  return p;
}

/// Whether the eigenvalue on the circle at `angle` moves inside for a small gain. Near it L = R/(z
/// - z_n), so it moves to z_n - gain R. It moves inside if L is in the lower half plane just above
/// it.
template <class Response>
bool moves_inside(const Response& response, double angle) {
  return response(Phasor(angle * (1.0 + 1e-6))).value.imag() < 0.0;
}

double transport(const LoopPlant& p) { return p.period_s + p.delay_s + p.effort_lag_s; }

/// Sum of the loop's time constants [s].
double time_constants(const LoopPlant& p, const LoopController& c) {
  double sum = transport(p);
  if (p.hand_stiffness > 0.0) {
    sum += damping_of(p) / p.hand_stiffness + c.injected_damping / p.hand_stiffness +
           std::sqrt(mass_of(p) / p.hand_stiffness);
  } else {
    sum += mass_of(p) / (damping_of(p) + c.injected_damping);
  }
  if (c.law == Law::kShapingFilter)
    sum += (1.0 + 2.0 * c.damping_ratio) / c.w0_rad_per_s;
  if (c.law == Law::kSpringDamper && c.stiffness > 0.0)
    sum += c.damping / c.stiffness;
  if (c.injected_damping > 0.0 && c.velocity_window > 0)
    sum += window_span(c.velocity_window) * p.period_s;
  if (c.injected_damping > 0.0 && c.velocity_window == 0 && c.velocity_filter_rad_per_s > 0.0)
    sum += 1.0 / c.velocity_filter_rad_per_s;
  return sum;
}

bool pulls_back(const LoopController& c) {
  return c.law == Law::kSpringDamper ? c.stiffness > 0.0 : c.gain > 0.0;
}
bool acts(const LoopController& c) {
  return c.law == Law::kSpringDamper ? c.stiffness > 0.0 || c.damping > 0.0 : c.gain != 0.0;
}

}  // namespace

InnerLimit inner_limit(const LoopPlant& bare, double velocity_filter_rad_per_s,
                       int velocity_window) {
  const LoopPlant p = with_regularising_damping(bare);
  const SampledPlant plant = sample_plant(p);
  const VelocityResponse velocity(p.period_s, velocity_filter_rad_per_s, velocity_window);
  const auto response = [&](const Phasor& at) {
    const Complex value = plant_response(plant, at) * velocity(at);
    return LoopSample{value, value};
  };
  const double resonance = resonance_of(p);
  if (swings_undamped(bare) && !moves_inside(response, resonance))
    return {0.0, resonance};
  const double filter = velocity_filter_rad_per_s > 0.0 && velocity_window == 0
                            ? 1.0 / velocity_filter_rad_per_s
                            : 0.0;
  CrossingSearch search((transport(p) + filter) / p.period_s + window_span(velocity_window),
                        plant.whole_delay + window_last(velocity_window));
  search.stop_at(resonance);
  const Crossing first = search.find(response);
  return {first.gain, first.angle};
}

CriticalStiffness critical_stiffness(const LoopPlant& plant, const LoopController& c) {
  return critical_stiffness(plant, c,
                            c.injected_damping > 0.0
                                ? inner_limit(plant, c.velocity_filter_rad_per_s, c.velocity_window)
                                : InnerLimit{});
}

CriticalStiffness critical_stiffness(const LoopPlant& plant, const LoopController& c,
                                     const InnerLimit& inner) {
  const bool gripped = plant.hand_stiffness > 0.0;
  // Released, the eigenvalue of the position is at 1. It moves inside for k > 0 only if the law
  // responds to a displacement at rest and the motion is damped. Without damping it is a double
  // eigenvalue, of which any lag moves one half outside.
  if (!gripped && !(pulls_back(c) && damping_of(plant) + c.injected_damping > 0.0))
    return {};

  if (c.injected_damping > 0.0 && c.injected_damping >= inner.damping)
    return {};
  if (!acts(c))
    return {kInfinity, 0.0};

  const LoopPlant p = with_regularising_damping(plant);
  const LoopResponse loop(p, c);
  const auto response = [&](const Phasor& at) {
    const Complex g = loop.damped_plant(at), value = loop.of(g, at);
    return LoopSample{value, c.law == Law::kSpringDamper ? g : value};
  };
  const double resonance = resonance_of(p);
  if (swings_undamped(plant) && c.injected_damping == 0.0 && !moves_inside(response, resonance))
    return {};
  const int late = c.injected_damping > 0.0 ? window_last(c.velocity_window) : 0;
  CrossingSearch search(time_constants(p, c) / p.period_s, loop.plant().whole_delay + late);
  search.stop_at(resonance);
  search.stop_at(c.injected_damping > 0.0 ? inner.angle : 0.0);
  if (c.law == Law::kShapingFilter)
    search.stop_at(2.0 * std::atan(0.5 * c.w0_rad_per_s * p.period_s));
  Crossing first = search.find(response);
  // A contact with K < 0 against the hand's spring gives way at rest.
  if (c.law != Law::kSpringDamper && c.gain < 0.0 && -plant.hand_stiffness / c.gain < first.gain)
    first = {-plant.hand_stiffness / c.gain, 0.0};
  return {first.gain, first.angle / p.period_s};
}

}  // namespace voxtouch::coupling::design
