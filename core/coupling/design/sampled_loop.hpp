#pragma once
/// The linear sampled-data model of the loop, exact between the samples.
///
///   (m + m_h) x'' + (b + b_h) x' + k_h x = f            continuous
///   f: zero-order hold of u[n] T, `delay_s` later (any fraction of T), then a first-order lag `effort_lag_s`
///   u[n] = -(controller(k x)[n] + B v^[n]),   v^[n] = a v^[n-1] + (1 - a) (x[n] - x[n-1]) / T,   a = exp(-w_v T), 0 where w_v = 0
///
/// Contact bilateral, nothing quantised. State-space by the matrix exponential.
#include <Eigen/Core>

#include <complex>
#include <optional>

namespace voxtouch {

/// What stands between contact and device, as a linear law.
struct LoopController {
  enum class Law { kShapingFilter, kSpringDamper, kDirect };
  Law law = Law::kShapingFilter;
  double w0_rad_per_s = 0.0, damping_ratio = 1.0;    ///< shaping filter
  double gain = 1.0;                                 ///< shaping filter and direct
  double stiffness = 0.0, damping = 0.0;             ///< spring-damper: c and r, massless object, backward difference
  double injected_damping = 0.0;                     ///< B >= 0
  double velocity_filter_rad_per_s = 0.0;            ///< w_v; 0: the plain difference
};

/// One device in one hand with one timing.
struct LoopPlant {
  double mass = 0.0, damping = 0.0;                          ///< device
  double hand_mass = 0.0, hand_damping = 0.0, hand_stiffness = 0.0;
  double period_s = 1e-3, delay_s = 0.0, effort_lag_s = 0.0;
};

/// Largest modulus of the closed loop's eigenvalues with contact stiffness `contact_stiffness`; < 1 means stable. A loop that
/// integrates freely (released device, no damping, k = 0) has modulus 1.
double spectral_radius(const LoopPlant& plant, const LoopController& controller, double contact_stiffness);

/// Where the loop becomes unstable.
struct CriticalStiffness {
  double stiffness = 0.0;        ///< stable for all 0 < k < stiffness; 0: for none; infinity: for all
  double frequency_rad_per_s = 0.0;  ///< of the oscillation that begins there
};
CriticalStiffness critical_stiffness(const LoopPlant& plant, const LoopController& controller);

/// Largest B for which the inner loop (injected damping alone, no contact) is stable.
double critical_damping(const LoopPlant& plant, double velocity_filter_rad_per_s);

/// Continuous approximation without hold, delay and lag (Routh): a hint only. Shaping filter without injected damping.
double routh_stiffness(const LoopPlant& plant, const LoopController& controller);

}  // namespace voxtouch
