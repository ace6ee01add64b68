#pragma once
/// Common requests of the designer's tests.
#include <algorithm>
#include <numbers>
#include <vector>

#include "core/coupling/design/design_axis.hpp"
#include "core/coupling/design/designer.hpp"
#include "core/coupling/design/filter_search.hpp"
#include "tests/unit/coupling_design/support.hpp"

namespace voxtouch::testing {

inline constexpr coupling::design::HandRange kPen{false, true, 0.02, 0.2, 0.5, 8.0, 20.0, 800.0};
inline constexpr coupling::design::HandRange kFirmPen{false, false, 0.1,   0.2,
                                                      3.0,   8.0,   200.0, 800.0};
inline constexpr coupling::design::HandRange kArm{false, true, 0.3, 2.0, 3.0, 30.0, 50.0, 600.0};
/// Rotation of a wrist: assumed, around the centre of the simulated arm's range.
inline constexpr coupling::design::HandRange kWrist{false, true, 0.003, 0.03, 0.1, 1.0, 1.0, 20.0};

inline bool has_reason(const coupling::design::Design& design,
                       coupling::design::DesignLimit limit) {
  return std::ranges::find(design.reasons, limit, &coupling::design::DesignReason::what) !=
         design.reasons.end();
}

/// The assumptions of the published tables: an unbounded damper on a filtered velocity, and no
/// minimum damping ratios.
inline void as_published(coupling::design::DesignGoals& goals) {
  goals.kind = "shaping_filter", goals.damping_force_ratio = 0.0, goals.velocity_windows = false,
  goals.min_damping = {0.0, 0.0};
}

/// Device damping with which the request would be passive at the highest cut-off.
inline double damping_required_any_cutoff(coupling::design::DesignProblem request) {
  const coupling::CouplingSpec spec = design_coupling(request).spec;
  request.goals.cutoff_hz = filter_settings(request).back().cutoff_hz;
  return judge_coupling(request, spec).translation.damping_required;
}

/// A stylus with hardly any damping, as in the published table: 1 ms of period and delay, two
/// samples lost in a row.
inline coupling::design::DesignProblem stylus() {
  coupling::design::DesignProblem r;
  r.device.name = "stylus";
  coupling::design::AxisModel& t = r.device.translation;
  t.inertia_min = 0.05, t.inertia_max = 0.1, t.damping = 0.005;
  t.coulomb_friction = 0.04, t.resolution = 0.03e-3, t.max_effort = 8.5;
  r.device.timing = {1e-3, 1e-3, 0.2, 2};
  r.hand.translation = kPen;
  r.contact = {50.0, 1000.0};
  as_published(r.goals);
  return r;
}

/// A robot arm as a hand controller, as in the published table: 2 ms of delay, 3 ms of lag, 200 N.
inline coupling::design::DesignProblem robot(double mass_min, double mass_max, double damping) {
  coupling::design::DesignProblem r;
  r.device.name = "robot";
  coupling::design::AxisModel& t = r.device.translation;
  t.inertia_min = mass_min, t.inertia_max = mass_max, t.damping = damping;
  t.coulomb_friction = 3.0, t.resolution = 20e-6, t.max_effort = 200.0;
  t.effort_bandwidth_hz = 1.0 / (2.0 * std::numbers::pi * 0.003);
  r.device.timing = {1e-3, 2e-3, 0.2, 2};
  r.hand.translation = kArm;
  r.contact = {50.0, 2000.0};
  as_published(r.goals);
  return r;
}

/// The figures that the simulated stylus reports about itself.
inline coupling::design::DesignProblem sim_stylus() {
  coupling::design::DesignProblem r = stylus();
  r.device.name = "sim-phantom";
  r.device.translation.inertia_min = 0.035, r.device.translation.inertia_max = 0.08;
  r.device.translation.max_stiffness = 800.0;
  r.device.timing.consecutive_losses = 1;
  r.goals.force_layer_depth_m = 0.004;
  return r;
}

/// The figures that the simulated arm reports about itself, with its torque.
inline coupling::design::DesignProblem sim_arm() {
  coupling::design::DesignProblem r = robot(3.0, 6.0, 30.0);
  r.device.name = "sim-lwr";
  r.device.gives_torque = true;
  r.device.translation.max_effort = 150.0, r.device.translation.max_stiffness = 5000.0;
  coupling::design::AxisModel& o = r.device.rotation;
  o.inertia_min = o.inertia_max = 0.1, o.damping = 0.3, o.coulomb_friction = 0.1,
  o.resolution = 1e-4;
  o.max_effort = 15.0, o.max_stiffness = 300.0,
  o.effort_bandwidth_hz = r.device.translation.effort_bandwidth_hz;
  r.device.timing.consecutive_losses = 1;
  r.hand.rotation = kWrist;
  r.contact = {100.0, 4000.0};
  r.contact_rotation = {0.5, 30.0};
  r.goals.force_layer_depth_m = 0.004;
  return r;
}

/// A random device of the population of the published validation, with a random hand and request.
inline coupling::design::DesignProblem random_request(Random& random) {
  const bool light = random.chance(0.5);
  coupling::design::DesignProblem r = light ? stylus() : robot(2.0, 5.0, 20.0);
  coupling::design::AxisModel& t = r.device.translation;
  t.inertia_min = light ? random.log(0.03, 0.15) : random.log(1.6, 10.0);
  t.inertia_max = t.inertia_min * random.uniform(1.0, 2.5);
  t.damping = light ? random.log(0.003, 1.0) : random.log(6.0, 63.0);
  t.resolution = random.log(1e-6, 63e-6);
  r.device.timing.period_s = random.log(0.25e-3, 4e-3);
  r.device.timing.delay_s = r.device.timing.period_s * random.uniform(0.0, 4.0);
  r.device.timing.consecutive_losses = random.below(3);
  r.hand.translation.may_release = random.chance(0.7);
  r.hand.translation.any_passive = random.chance(0.1);
  r.contact.all_points = light ? random.log(20.0, 5000.0) : random.log(100.0, 16000.0);
  r.contact.one_point = std::min(r.contact.all_points, 50.0);
  r.goals.free_cap = random.chance(0.3);
  r.goals.allow_injected_damping = random.chance(0.8);
  constexpr const char* kKinds[] = {"shaping_filter", "shaping_filter", "spring_damper", "direct",
                                    "auto"};
  r.goals.kind = kKinds[random.below(5)];
  return r;
}

inline coupling::design::LoopController law_of_translation(const coupling::design::DesignProblem& r,
                                                           const coupling::CouplingSpec& spec) {
  return voxtouch::coupling::design::controller_of(spec, coupling::design::axis_problems(r)[0],
                                                   coupling::design::arm_squared(r));
}

inline coupling::design::Design designed(const coupling::design::DesignProblem& request) {
  return design_coupling(request);
}

}  // namespace voxtouch::testing
