#pragma once
/// Closed rules: how stiff a contact may be for every hand that creates no energy, whatever its mass and stiffness.
#include "core/coupling/design/loop_parts.hpp"

namespace voxtouch {

/// Shape constants of the filter's impulse response h: c' = w0 int t |h| dt, S = int |h| dt. d > 0.
double lag_shape(double damping_ratio);       ///< c'(d); 2 d for d >= 1
double overshoot_shape(double damping_ratio); ///< S(d); 1 for d >= 1

/// Rule P: largest K k for the shaping filter, any passive operator, any mass, any monotone unilateral contact, with jitter and
/// loss as `timing` says. w0 = infinity: no filter.
double passive_stiffness_filter(double w0_rad_per_s, double damping_ratio, double device_damping, const LoopTiming& timing,
                                double effort_lag_s);
/// The same for a linear contact at uniform time (generalised Colgate bound); the whole delay rounded up to samples.
double linear_passive_stiffness_filter(double w0_rad_per_s, double damping_ratio, double device_damping,
                                       const LoopTiming& timing, double effort_lag_s);
/// Dry friction below which a limit cycle of about one encoder step remains: S K k q / 2.
double limit_cycle_friction(double damping_ratio, double shown_stiffness, double resolution);

/// Colgate: largest stiffness without filter, b > k T/2 (1 + 2 n) + |B|, n whole samples of delay.
double colgate_stiffness(double device_damping, double injected_damping, double period_s, int delay_samples);

/// Spring-damper c, r for any passive hand and any passive world (discrete Llewellyn, backward differences, n samples of delay).
/// Device damping needed.
double llewellyn_damping(double stiffness, double damping, double period_s, int delay_samples);
/// The pair with the largest c that a device damping allows.
struct SpringDamperPair {
  double stiffness = 0.0, damping = 0.0;
};
SpringDamperPair llewellyn_optimum(double device_damping, double period_s, int delay_samples);

}  // namespace voxtouch
