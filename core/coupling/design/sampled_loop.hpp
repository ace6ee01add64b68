#pragma once
/// The linear sampled-data model of the loop, exact at the samples.
///
/// Continuous part:
///
///     (m + m_h) x'' + (b + b_h) x' + k_h x = f
///
/// f is the zero-order hold of u[n] over T, `delay_s` later (any fraction of T), then a first-order
/// lag `effort_lag_s`. Discrete part:
///
///     u[n]  = -(controller(k x)[n] + B v^[n])
///     v^[n] = a v^[n-1] + (1 - a) (x[n] - x[n-1]) / T,   a = exp(-w_v T), 0 if w_v = 0
///
/// With a window, v^ is the sum of velocity_window.hpp. The contact is bilateral and nothing is
/// quantised. The state space follows from the matrix exponential.
///
/// For design time only. Numbers must satisfy `check` (loop_parts.hpp) and `validate`
/// (coupling_spec.hpp).
#include <limits>
#include <numbers>

#include "core/coupling/coupling_spec.hpp"
#include "core/coupling/velocity_window.hpp"

namespace voxtouch::coupling::design {

/// A velocity estimate that damping may act on.
struct VelocityEstimate {
  double filter_hz = 100.0;  ///< of the first-order filter, > 0; without a window
  int window = 0;            ///< n of velocity_window.hpp; 0: the first-order filter
  double filter_rad_per_s() const noexcept { return 2.0 * std::numbers::pi * filter_hz; }
};
inline VelocityEstimate velocity_of(const CouplingSpec& spec) noexcept {
  return {spec.velocity_filter_hz, static_cast<int>(spec.velocity_window)};
}

/// The linear law between contact and device.
struct LoopController {
  enum class Law { kShapingFilter, kSpringDamper, kDirect };
  Law law = Law::kShapingFilter;
  /// Shaping filter: both > 0; the filter of core/coupling/pt2.hpp.
  double w0_rad_per_s = 0.0, damping_ratio = 1.0;
  double gain = 1.0;  ///< shaping filter and direct; K, dimensionless, of any sign
  /// Spring-damper: c and r, massless object, backward difference.
  double stiffness = 0.0, damping = 0.0;
  double injected_damping = 0.0;           ///< B >= 0
  double velocity_filter_rad_per_s = 0.0;  ///< w_v; 0: the plain difference
  int velocity_window = 0;                 ///< n of velocity_window.hpp; 0: the first-order filter
  void use(const VelocityEstimate& v) noexcept {
    velocity_filter_rad_per_s = v.filter_rad_per_s(), velocity_window = v.window;
  }
};

/// One device in one hand with one timing. All values >= 0; mass + hand_mass and period_s > 0.
struct LoopPlant {
  double mass = 0.0, damping = 0.0;  ///< device
  double hand_mass = 0.0, hand_damping = 0.0, hand_stiffness = 0.0;
  double period_s = 1e-3, delay_s = 0.0, effort_lag_s = 0.0;
  bool operator==(const LoopPlant&) const = default;
};

/// A corner of the ranges of device, hand and timing.
struct LoopCase {
  LoopPlant plant;
  bool gripped = false;  ///< false: the device is released
  bool slow = false;     ///< slowest timing instead of the nominal one
};

/// Spectral radius of the closed loop with contact stiffness `contact_stiffness`; < 1 means stable.
/// Takes 10 to 100 us, increasing with the delay. Throws std::invalid_argument if the numbers are
/// too far apart for a matrix.
/// A freely integrating loop (the device is released and no contact acts: k = 0 or K = 0) has
/// modulus 1: its position stays constant. That eigenvalue is removed first, and so is that of an
/// undamped free velocity. Together they would be a double root, which rounding would spread by
/// 1e-8 to either side. With any k > 0 nothing is removed.
double spectral_radius(const LoopPlant& plant, const LoopController& controller,
                       double contact_stiffness);

/// Damping ratio of the dominant oscillating mode: of the eigenvalues z that are not on the
/// positive real axis, the one of largest modulus.
///     -Re s / |s|,   s = ln z / T
/// Returns 1 if no mode oscillates, 0 for a constant oscillation and a negative ratio for a growing
/// one. Cost and errors as `spectral_radius`.
double slowest_damping_ratio(const LoopPlant& plant, const LoopController& controller,
                             double contact_stiffness);

/// The stability limit of the loop.
struct CriticalStiffness {
  /// Stable for all 0 < k < stiffness; 0: unstable for any k; infinity: stable for all.
  double stiffness = 0.0;
  /// Of the oscillation at the limit; 0 if stiffness is 0 or infinite.
  double frequency_rad_per_s = 0.0;
};

/// Critical stiffness by the Nyquist criterion. Takes some microseconds.
/// For every law the closed loop is 1 + k L(z) = 0 with an L that does not depend on k:
///
///     filter or direct:  L = C(z) G'(z)
///     spring-damper:     L = 1/Z(z) + G'(z),   Z = c + r (1 - z^-1)/T   (from F = k x Z/(k + Z))
///     G' = G/(1 + G B V), the plant with its injected damping
///
/// The result is the least -1/L over the frequencies where L is real and negative. L is computed
/// from its factors, not from matrices of the loop. Injected damping at or above `inner_limit`
/// gives 0.
CriticalStiffness critical_stiffness(const LoopPlant& plant, const LoopController& controller);

/// The stability limit of the inner loop (injected damping alone, no contact).
struct InnerLimit {
  double damping = std::numeric_limits<double>::infinity();  ///< stable for all 0 < B < damping
  double angle = 0.0;  ///< of the oscillation at the limit [rad per sample]
};
InnerLimit inner_limit(const LoopPlant& plant, double velocity_filter_rad_per_s,
                       int velocity_window = 0);

/// `critical_stiffness` with an already computed `inner_limit` of the plant on the controller's
/// velocity. It is unused without injected damping.
CriticalStiffness critical_stiffness(const LoopPlant& plant, const LoopController& controller,
                                     const InnerLimit& inner);

}  // namespace voxtouch::coupling::design
