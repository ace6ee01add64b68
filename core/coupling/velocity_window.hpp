#pragma once
/// The velocity estimate of a window: the mean speed over the last n samples, looked ahead by how
/// it has changed.
///
///     v^ = u + (u - w) / 2,   u = (x[m] - x[m - n]) / (n T),   w = (x[m - n] - x[m - 3n]) / (2n T)
///
/// Exact at a constant velocity, and at a constant acceleration n T / 4 ahead, where u is n T / 2
/// behind. An encoder that is off by up to q / 2 at every sample makes v^ wrong by at most q/2
/// times the sum of the steps between its weights, as the first-order filter by (1 - a) q / T: see
/// `window_step_ratio`. For as much of that, u damps more than the filter, and v^ more than u: what
/// is late in w counts against the damping anyway, and is taken off.
namespace voxtouch::coupling {

/// Largest n: 15 differences.
inline constexpr int kMaxVelocityWindow = 5;

/// Samples of u and of w, and of both: differences that v^ looks back on.
constexpr int window_last(int n) noexcept { return n; }
constexpr int window_before(int n) noexcept { return 2 * n; }
constexpr int window_span(int n) noexcept { return window_last(n) + window_before(n); }
/// Of u - w.
inline constexpr double kWindowLead = 0.5;

/// Weight of the difference of `ago` samples ago, 0 <= ago < window_span(n); they sum up to 1.
constexpr double window_weight(int n, int ago) noexcept {
  return ago < window_last(n) ? (1.0 + kWindowLead) / window_last(n)
                              : -kWindowLead / window_before(n);
}
/// Largest error of v^ that positions off by up to q / 2 either way may make, in q / T.
constexpr double window_step_ratio(int n) noexcept {
  return (1.0 + kWindowLead) / window_last(n) + kWindowLead / window_before(n);
}
/// Sum of the weights without their signs: v^ is never more than this times the largest difference
/// quotient.
inline constexpr double kWindowGain = 1.0 + 2.0 * kWindowLead;

}  // namespace voxtouch::coupling
