#pragma once
/// Closed rules: how stiff a contact may be for every hand that creates no energy, whatever its
/// mass and stiffness.
///
/// Arithmetic for the time of designing. Numbers are taken as `check` (loop_parts.hpp) and
/// `validate` (coupling_spec.hpp) leave them: finite, of the right sign. A device without damping
/// gets 0 from all of them.
#include "core/coupling/design/loop_parts.hpp"

namespace voxtouch::coupling::design {

/// Shape constants of the continuous filter's impulse response h: c' = w0 int t |h| dt, S = int |h|
/// dt. d > 0. From the sum over the half waves of h, P = pi/sqrt(1 - d^2) long in units of 1/w0,
/// each e^{-d P} of the one before.
double lag_shape(double damping_ratio);  ///< c'(d) = 2 d S + P / (2 sinh^2(d P/2)); 2 d for d >= 1
double overshoot_shape(double damping_ratio);  ///< S(d) = coth(d P/2); 1 for d >= 1

/// The same two sums over the sampled filter's own impulse response: `lag` = w0 T sum i |h_i|,
/// `overshoot` = sum |h_i|. With d < 1 they are above the continuous ones, by some (w0 T)^2/6: 1.7
/// % of c' at w0 T = 0.31, d = 0.577. With d >= 1 and w0 T <= 2 no tap is negative and they are 2 d
/// and 1 exactly. Below w0 T = 1e-3 or d = 0.02, where a sum would be long, the continuous ones
/// times 1 + (w0 T)^2, which is above.
struct FilterShape {
  double lag = 0.0, overshoot = 1.0;
};
FilterShape sampled_filter_shape(double w0_rad_per_s, double damping_ratio, double period_s);

/// Rule P: largest K k for the shaping filter, any passive operator, any mass, any monotone
/// unilateral contact, with jitter and loss as `timing` says:
///
///     K k { (T_max/T) c'/w0 + S [delay + lag + (1/2 + n_loss) T_max] } <= b,    T_max = (1 +
///     jitter) T.
///
/// The force is a sum of past contact forces weighted by the filter's taps; a contact force of age
/// A may extract up to k |v(t)| int |v| over that age, and the device's damping pays for it. The
/// taps are the sampled filter's own (sampled_filter_shape), with coefficients that do not follow
/// the jitter. w0 = infinity: no filter. The sum of ages is exact for a delay of whole periods; see
/// linear_passive_stiffness_filter for the others, where n_loss = 0 leaves no room for it.
double passive_stiffness_filter(double w0_rad_per_s, double damping_ratio, double device_damping,
                                const LoopTiming& timing, double effort_lag_s);
/// The same for a linear contact at uniform time (jitter and loss are not looked at), exact:
/// Colgate's bound with the filter, any fraction of delay and the lag in it. The loop of contact,
/// filter and hold takes a signal's samples and answers in all their aliases, so it is passive with
/// the damping b if b I + the Hermitian part of k a c^H is not negative, with a and c the aliases'
/// hold and sampling. For a pure hold and a delay of n whole samples a and c are parallel, which
/// leaves
///
///     K k max over theta of -(T/2) Im[e^{-j (n + 1/2) theta} H(e^{j theta})] / sin(theta/2) <= b,
///
/// n T + T/2 + 2 d/w0 at theta = 0; for d < 1/sqrt(2) the maximum lies higher up. A delay that is
/// not whole needs a little more than its length (up to T^2/16 over the lag): hands that are no
/// linear spring and mass can swing at the sample rate.
double linear_passive_stiffness_filter(double w0_rad_per_s, double damping_ratio,
                                       double device_damping, const LoopTiming& timing,
                                       double effort_lag_s);
/// Dry friction below which a limit cycle of about one encoder step remains: S K k q / 2.
double limit_cycle_friction(double damping_ratio, double displayed_stiffness, double resolution);

/// Colgate: largest stiffness without filter, b > k T/2 (1 + 2 n) + |B|, n whole samples of delay.
/// 0 where |B| >= b.
double colgate_stiffness(double device_damping, double injected_damping, double period_s,
                         int delay_samples);

/// Spring-damper c, r for any passive hand and any passive world (discrete Llewellyn, backward
/// differences, n samples of delay). Device damping needed, with a = c T/2:
///
///     b >= max over phi in (0, pi/2] of [a^2 U^2 + r (r + 2 a) sin^2((n+1) phi)] / (r + a),   U =
///     sin((n+1) phi)/sin(phi)
///
/// (phi half the angle per sample). The maximum lies below phi = pi/(2 (n+1)): from there on U
/// falls and the sine has had its largest value.
double llewellyn_damping(double stiffness, double damping, double period_s, int delay_samples);
/// The pair with the largest c that a device damping allows.
struct SpringDamperPair {
  double stiffness = 0.0, damping = 0.0;
};
SpringDamperPair llewellyn_optimum(double device_damping, double period_s, int delay_samples);

}  // namespace voxtouch::coupling::design
