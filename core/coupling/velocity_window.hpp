#pragma once
/// The velocity estimate of a window: the mean speed over the last n samples, extrapolated by its
/// change.
///
///     v^ = u + (u - w) / 2,
///     u  = (x[m] - x[m - n]) / (n T),   w = (x[m - n] - x[m - 3n]) / (2n T)
///
/// It is exact at constant velocity. At constant acceleration it leads by n T / 4, where u lags by
/// n T / 2. Position errors of up to q / 2 give an error of v^ of at most q/2 times the sum of the
/// steps between its weights; see `window_step_ratio`. The first-order filter gives (1 - a) q / T.
/// For equal error, u damps more than the filter, and v^ more than u: the late part w acts against
/// the damping and is subtracted.
namespace voxtouch::coupling {

/// Largest n: 15 differences.
inline constexpr int kMaxVelocityWindow = 5;

/// Number of differences in u, in w, and in both.
constexpr int window_last(int n) noexcept { return n; }
constexpr int window_before(int n) noexcept { return 2 * n; }
constexpr int window_span(int n) noexcept { return window_last(n) + window_before(n); }
/// Weight of u - w.
inline constexpr double kWindowLead = 0.5;

/// Weight of the difference `ago` samples ago, 0 <= ago < window_span(n); the weights sum to 1.
constexpr double window_weight(int n, int ago) noexcept {
  return ago < window_last(n) ? (1.0 + kWindowLead) / window_last(n)
                              : -kWindowLead / window_before(n);
}
/// Largest error of v^, in q / T, for position errors of up to q / 2.
constexpr double window_step_ratio(int n) noexcept {
  return (1.0 + kWindowLead) / window_last(n) + kWindowLead / window_before(n);
}
/// Sum of the absolute weights: v^ never exceeds this times the largest difference quotient.
inline constexpr double kWindowGain = 1.0 + 2.0 * kWindowLead;

}  // namespace voxtouch::coupling
