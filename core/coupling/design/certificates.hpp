#pragma once
/// Closed-form rules for the stiffness of a contact with any passive hand, of any mass and
/// stiffness.
///
/// For design time only. Numbers must satisfy `check` (loop_parts.hpp) and `validate`
/// (coupling_spec.hpp). A device without damping gives 0 in all rules.
#include "core/coupling/design/loop_parts.hpp"

namespace voxtouch::coupling::design {

/// Shape constants of the continuous filter's impulse response h, for d > 0:
///
///     c' = w0 int t |h| dt,   S = int |h| dt
///
/// They follow from the sum over the half waves of h. Each is P = pi/sqrt(1 - d^2) long in units of
/// 1/w0, and e^{-d P} times the previous one.
/// c'(d) = 2 d S + P / (2 sinh^2(d P/2)); 2 d for d >= 1.
double lag_shape(double damping_ratio);
double overshoot_shape(double damping_ratio);  ///< S(d) = coth(d P/2); 1 for d >= 1

/// The same sums over the impulse response of the sampled filter:
///
///     lag = w0 T sum i |h_i|,   overshoot = sum |h_i|
///
/// With d < 1 they exceed the continuous ones by about (w0 T)^2/6: 1.7 % of c' at w0 T = 0.31, d =
/// 0.577. With d >= 1 and w0 T <= 2 no tap is negative, and they are exactly 2 d and 1. Below w0 T
/// = 1e-3 or d = 0.02 the sum would be long; the continuous values times 1 + (w0 T)^2 are used as
/// upper bounds.
struct FilterShape {
  double lag = 0.0, overshoot = 1.0;
};
FilterShape sampled_filter_shape(double w0_rad_per_s, double damping_ratio, double period_s);

/// Rule P: the largest K k of the shaping filter for any passive operator, any mass and any
/// monotone unilateral contact, with jitter and loss of `timing`:
///
///     K k { (T_max/T) c'/w0 + S [delay + lag + (1/2 + n_loss) T_max] } <= b,
///     T_max = (1 + jitter) T
///
/// The force is a sum of past contact forces weighted by the taps of the filter. A contact force of
/// age A may extract up to k |v(t)| int |v| over that age, and the damping of the device
/// compensates it. The taps are those of the sampled filter (sampled_filter_shape), with
/// coefficients that do not follow the jitter. w0 = infinity: no filter. The sum of ages is exact
/// for a delay of whole periods. For other delays with n_loss = 0 see
/// linear_passive_stiffness_filter.
double passive_stiffness_filter(double w0_rad_per_s, double damping_ratio, double device_damping,
                                const LoopTiming& timing, double effort_lag_s);
/// The same for a linear contact at uniform time (jitter and loss are ignored), exact: Colgate's
/// bound with the filter, any fractional delay and the lag.
///
/// The loop of contact, filter and hold samples a signal and responds in all its aliases. Let a and
/// c be the hold and the sampling of the aliases. The loop is passive with the damping b if b I
/// plus the Hermitian part of k a c^H is positive semidefinite. For a pure hold and a delay of n
/// whole samples a and c are parallel, which leaves
///
///     K k max over theta of -(T/2) Im[e^{-j (n + 1/2) theta} H(e^{j theta})] / sin(theta/2) <= b
///
/// At theta = 0 the maximum is n T + T/2 + 2 d/w0; for d < 1/sqrt(2) it lies at a larger theta. A
/// fractional delay needs slightly more than its length, up to T^2/16 over the lag. Hands that are
/// not a linear spring and mass can oscillate at the sample rate.
double linear_passive_stiffness_filter(double w0_rad_per_s, double damping_ratio,
                                       double device_damping, const LoopTiming& timing,
                                       double effort_lag_s);
/// Dry friction below which a limit cycle of about one encoder step remains: S K k q / 2.
double limit_cycle_friction(double damping_ratio, double displayed_stiffness, double resolution);

/// Colgate's bound: the largest stiffness without filter for n whole samples of delay,
///     b > k T/2 (1 + 2 n)
double colgate_stiffness(double device_damping, double period_s, int delay_samples);

/// Device damping that a spring-damper c, r requires for any passive hand and any passive
/// environment (discrete Llewellyn condition, backward differences, n samples of delay). With a = c
/// T/2 and phi half the angle per sample:
///
///     b >= max over phi in (0, pi/2] of [a^2 U^2 + r (r + 2 a) sin^2((n+1) phi)] / (r + a),
///     U = sin((n+1) phi)/sin(phi)
///
/// The maximum lies below phi = pi/(2 (n+1)), because U decreases beyond it and the sine has passed
/// its maximum.
double llewellyn_damping(double stiffness, double damping, double period_s, int delay_samples);
/// The pair with the largest c for a given device damping.
struct SpringDamperPair {
  double stiffness = 0.0, damping = 0.0;
};
SpringDamperPair llewellyn_optimum(double device_damping, double period_s, int delay_samples);

}  // namespace voxtouch::coupling::design
