#pragma once
/// Which coupling is asked for, and what is wrong with the asking.
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace voxtouch::coupling {

/// The standard fraction of what contact and effects give that injected damping may add: see
/// CouplingSpec::damping_force_ratio.
inline constexpr double kDefaultDampingForceRatio = 0.35;
/// Force below perception [N].
inline constexpr double kQuietForceN = 0.05;

/// A coupling and its parameters; those of the other kinds are ignored.
struct CouplingSpec {
  std::string kind = "shaping_filter";  ///< shaping_filter | spring_damper | direct
  /// Shaping filter. `cutoff_hz` = w0 / (2 pi): where the phase passes -90 degrees and the gain is
  /// K/(2 d). It is the -3 dB frequency only for d = 1/sqrt(2); with d = 1 the filter is down 3 dB
  /// at 0.644 of it already.
  double cutoff_hz = 100.0;
  double damping_ratio = 0.7071067811865476;  ///< d, > 0
  double gain = 1.0;  ///< K, dimensionless (force in, force out), > 0 in a scene, >= 0 at run time
  double stiffness_n_per_m = 500.0;  ///< spring-damper: c, > 0
  double damping_ns_per_m = 2.0;     ///< spring-damper: r, >= 0
  /// All kinds. What the hand is shown of the contact's stiffness, as a matrix, stays below both
  /// caps: by a spring in series with the contact (core/rendering/series_spring.hpp). Infinity: no
  /// cap.
  double stiffness_cap_n_per_m = std::numeric_limits<double>::infinity();
  double stiffness_cap_nm_per_rad = std::numeric_limits<double>::infinity();
  /// All kinds. Damping against the tool's motion while in contact, along the directions that the
  /// contact pushes in, never pulling; of a velocity that is a first-order filtered difference or
  /// of a window (velocity_window.hpp). >= 0.
  double injected_damping_ns_per_m = 0.0;
  double injected_damping_nms_per_rad = 0.0;
  double velocity_filter_hz = 100.0;  ///< > 0; not used behind a window
  std::uint32_t velocity_window =
      0;  ///< n of the window, 0 to kMaxVelocityWindow; 0: the first-order filter
  /// The linear part of that velocity goes over to the one of a slower first-order filter where the
  /// encoder's steps may be all that they differ by: along each axis of W by up to
  /// `velocity_band_m_per_s`. What damping does to larger movements is changed by no more than
  /// that. 0 either: it does not.
  double slow_velocity_hz = 0.0;
  double velocity_band_m_per_s = 0.0;
  /// Most that injected damping may add to the law's force, as a fraction of that, and [N] that it
  /// may add in addition, which is below perception: so a touch begins with the contact. What it
  /// takes is bounded by never pulling alone, and so is what it does to a torque. Ratio 0: without
  /// that bound.
  double damping_force_ratio = kDefaultDampingForceRatio;
  double damper_free_n = kQuietForceN;
  bool operator==(const CouplingSpec&) const = default;
};

/// What the device can give, said in the units of W: its force limit / force_scale, its torque
/// limit * position_scale / force_scale (see core/rendering/device_mapping.hpp). Infinity = no
/// limit; 0 = the device gives none of it.
struct CouplingLimits {
  double max_force_n = std::numeric_limits<double>::infinity();
  double max_torque_nm = std::numeric_limits<double>::infinity();
  /// What a swing is judged by, likewise in W: encoder step, what the device's own damping and
  /// friction take, and how late its force is: delay, and time constant behind it. 0: unknown, or
  /// none.
  double resolution_m = 0.0, damping_ns_per_m = 0.0, coulomb_friction_n = 0.0;
  double delay_s = 0.0, force_lag_s = 0.0;
};

/// Above this w0 T [rad] the sampled filter rings visibly and its cut-off is off by more than 3 %:
/// warned.
inline constexpr double kWarnCutoffRad = 0.6;

/// One thing that is wrong, or doubtful, with a spec.
struct CouplingIssue {
  std::string field;     ///< member of CouplingSpec, as scenes spell it; or the argument's name
  std::string sentence;  ///< names field, value and rule
  bool refuse = true;    ///< false: a warning
};

/// Checks the parameters of `spec.kind` for a loop with period `sample_time_s` [s]. Empty: all is
/// well.
std::vector<CouplingIssue> validate(const CouplingSpec& spec, const CouplingLimits& limits,
                                    double sample_time_s);

/// w0 [rad/s] of a shaping filter.
double cutoff_rad_per_s(const CouplingSpec& spec) noexcept;
/// Whether injected damping acts on a slower velocity within a band.
bool damps_on_slow_velocity(const CouplingSpec& spec) noexcept;
/// Low-frequency lag [s] that the coupling puts into the loop: 2 d / w0 of the shaping filter, 0 of
/// the others (the spring-damper leads, it does not lag).
double lag_s(const CouplingSpec& spec) noexcept;
/// Most stiffness that reaches the hand where the contact has `contact_n_per_m`: with k the smaller
/// of it and the cap, K k, c k / (c + k), or k. At rest, in W.
double displayed_stiffness_n_per_m(const CouplingSpec& spec, double contact_n_per_m) noexcept;

}  // namespace voxtouch::coupling
