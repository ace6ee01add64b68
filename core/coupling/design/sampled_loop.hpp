#pragma once
/// The linear sampled-data model of the loop, exact between the samples.
///
///   (m + m_h) x'' + (b + b_h) x' + k_h x = f            continuous
///   f: zero-order hold of u[n] T, `delay_s` later (any fraction of T), then a first-order lag
///   `effort_lag_s` u[n] = -(controller(k x)[n] + B v^[n]),   v^[n] = a v^[n-1] + (1 - a) (x[n] -
///   x[n-1]) / T,   a = exp(-w_v T), 0 where w_v = 0;
///     or, with a window, the sum of velocity_window.hpp
///
/// Contact bilateral, nothing quantised. State-space by the matrix exponential.
///
/// All functions are pure arithmetic for the time of designing, and may allocate. Numbers are taken
/// as `check` (loop_parts.hpp) and `validate` (coupling_spec.hpp) leave them: finite, of the right
/// sign.
#include <limits>
#include <numbers>

#include "core/coupling/coupling_spec.hpp"
#include "core/coupling/velocity_window.hpp"

namespace voxtouch::coupling::design {

/// A velocity that damping may act on.
struct VelocityEstimate {
  double filter_hz = 100.0;  ///< of the first-order filter, > 0; without a window
  int window = 0;            ///< n of velocity_window.hpp; 0: the first-order filter
  double filter_rad_per_s() const noexcept { return 2.0 * std::numbers::pi * filter_hz; }
};
inline VelocityEstimate velocity_of(const CouplingSpec& spec) noexcept {
  return {spec.velocity_filter_hz, static_cast<int>(spec.velocity_window)};
}

/// What stands between contact and device, as a linear law.
struct LoopController {
  enum class Law { kShapingFilter, kSpringDamper, kDirect };
  Law law = Law::kShapingFilter;
  double w0_rad_per_s = 0.0,
         damping_ratio = 1.0;  ///< shaping filter: > 0 both; the filter of core/coupling/pt2.hpp
  double gain = 1.0;           ///< shaping filter and direct; K, dimensionless, of any sign
  double stiffness = 0.0,
         damping = 0.0;           ///< spring-damper: c and r, massless object, backward difference
  double injected_damping = 0.0;  ///< B >= 0
  double velocity_filter_rad_per_s = 0.0;  ///< w_v; 0: the plain difference
  int velocity_window = 0;                 ///< n of velocity_window.hpp; 0: the first-order filter
  void use(const VelocityEstimate& v) noexcept {
    velocity_filter_rad_per_s = v.filter_rad_per_s(), velocity_window = v.window;
  }
};

/// One device in one hand with one timing. All >= 0; mass + hand_mass and period_s > 0.
struct LoopPlant {
  double mass = 0.0, damping = 0.0;  ///< device
  double hand_mass = 0.0, hand_damping = 0.0, hand_stiffness = 0.0;
  double period_s = 1e-3, delay_s = 0.0, effort_lag_s = 0.0;
  bool operator==(const LoopPlant&) const = default;
};

/// Largest modulus of the closed loop's eigenvalues with contact stiffness `contact_stiffness`; < 1
/// means stable. A loop that integrates freely (the device is released and no contact reaches it:
/// k = 0 or K = 0) has modulus 1: its position stays where it is. That eigenvalue is taken out
/// before the others are computed, as is that of an undamped free velocity: together they are a
/// double root, which rounding would spread by 1e-8 to either side. With any k > 0 nothing is taken
/// out. 10 to 100 us, the more the longer the delay. Throws std::invalid_argument where the numbers
/// are too far apart for a matrix.
double spectral_radius(const LoopPlant& plant, const LoopController& controller,
                       double contact_stiffness);

/// Damping ratio -Re s / |s|, s = ln z / T, of the slowest motion that swings: of the closed loop's
/// eigenvalues z that are not on the positive real axis the one of largest modulus. 1 where nothing
/// swings, 0 where a swing stays, below 0 where it grows. Cost and errors as `spectral_radius`.
double slowest_damping_ratio(const LoopPlant& plant, const LoopController& controller,
                             double contact_stiffness);

/// Where the loop becomes unstable.
struct CriticalStiffness {
  double stiffness = 0.0;  ///< stable for all 0 < k < stiffness; 0: unstable from the softest k on;
                           ///< infinity: stable for all
  double frequency_rad_per_s =
      0.0;  ///< of the oscillation that begins there; 0 where stiffness is 0 or infinite
};

/// Nyquist's criterion. For every law the closed loop is 1 + k L(z) = 0 with an L that does not
/// depend on k: C(z) G'(z) behind a filter or nothing, 1/Z(z) + G'(z) for the spring-damper with Z
/// = c + r (1 - z^-1)/T (from F = k x Z/(k + Z)), where G' = G/(1 + G B V) is the plant with its
/// injected damping. The result is the least -1/L over the frequencies where L is real and
/// negative. L comes from its factors, not from matrices of the loop; some microseconds. Injected
/// damping at or above `critical_damping` gives 0.
CriticalStiffness critical_stiffness(const LoopPlant& plant, const LoopController& controller);

/// Where the inner loop (injected damping alone, no contact) becomes unstable.
struct InnerLimit {
  double damping = std::numeric_limits<double>::infinity();  ///< stable for all 0 < B < damping
  double angle = 0.0;  ///< of the oscillation that begins there [rad per sample]
};
InnerLimit inner_limit(const LoopPlant& plant, double velocity_filter_rad_per_s,
                       int velocity_window = 0);
/// The `damping` of `inner_limit`.
double critical_damping(const LoopPlant& plant, double velocity_filter_rad_per_s,
                        int velocity_window = 0);

/// `critical_stiffness` for who knows the plant's `inner_limit` on the controller's velocity, which
/// is not looked at without injected damping.
CriticalStiffness critical_stiffness(const LoopPlant& plant, const LoopController& controller,
                                     const InnerLimit& inner);

}  // namespace voxtouch::coupling::design
