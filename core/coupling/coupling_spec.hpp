#pragma once
/// Coupling specification and its validation.
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace voxtouch::coupling {

/// Default ratio of the force that injected damping may add to that of contact and effects; see
/// CouplingSpec::damping_force_ratio.
inline constexpr double kDefaultDampingForceRatio = 0.35;
/// Force below the threshold of perception [N].
inline constexpr double kQuietForceN = 0.05;

/// A coupling and its parameters. Parameters of other kinds are ignored.
struct CouplingSpec {
  std::string kind = "shaping_filter";  ///< shaping_filter | spring_damper | direct
  /// Shaping filter. `cutoff_hz` = w0 / (2 pi): the frequency of phase -90 degrees and gain K/(2
  /// d). It is the -3 dB frequency only for d = 1/sqrt(2). With d = 1 the gain is -3 dB at 0.644 of
  /// it.
  double cutoff_hz = 100.0;
  double damping_ratio = 0.7071067811865476;  ///< d, > 0
  /// K, dimensionless (force in, force out), > 0 in a scene, >= 0 at run time.
  double gain = 1.0;
  double stiffness_n_per_m = 500.0;  ///< spring-damper: c, > 0
  double damping_ns_per_m = 2.0;     ///< spring-damper: r, >= 0
  /// All kinds. The displayed contact stiffness, as a matrix, stays below both caps. A spring in
  /// series with the contact enforces it (core/rendering/series_spring.hpp). Infinity: no cap.
  double stiffness_cap_n_per_m = std::numeric_limits<double>::infinity();
  double stiffness_cap_nm_per_rad = std::numeric_limits<double>::infinity();
  /// All kinds. Damping against the tool's motion during contact, along the directions of the
  /// contact force; it never pulls. It acts on a first-order filtered difference or on the velocity
  /// of a window (velocity_window.hpp). >= 0.
  double injected_damping_ns_per_m = 0.0;
  double injected_damping_nms_per_rad = 0.0;
  double velocity_filter_hz = 100.0;  ///< > 0; unused with a window
  /// `n` of the window, 0 to kMaxVelocityWindow; 0: the first-order filter.
  std::uint32_t velocity_window = 0;
  /// Cut-off of a slow velocity estimate and the width of its band. The linear velocity of the
  /// damping follows the slow estimate along each axis of W, up to this distance from the fast one.
  /// The band covers differences that encoder quantisation may cause; larger motions are damped
  /// with an error of at most the band. A value of 0 disables it.
  double slow_velocity_hz = 0.0;
  double velocity_band_m_per_s = 0.0;
  /// Upper bound of the force that injected damping may add to the law's force:
  ///
  ///     damping_force_ratio * |law's force| + damping_force_offset_n
  ///
  /// The offset is below perception, so a touch begins with the contact force. The force that
  /// damping takes away is limited only by the rule that it never pulls; so is its torque.
  /// Ratio 0: no bound.
  double damping_force_ratio = kDefaultDampingForceRatio;
  double damping_force_offset_n = kQuietForceN;
  bool operator==(const CouplingSpec&) const = default;
};

/// Limits of the device in units of W: force limit / force_scale, torque limit * position_scale /
/// force_scale (core/rendering/device_mapping.hpp). Infinity: no limit. 0: the device cannot give
/// it.
struct CouplingLimits {
  double max_force_n = std::numeric_limits<double>::infinity();
  double max_torque_nm = std::numeric_limits<double>::infinity();
  /// Device parameters for the detection of limit cycles, also in W: encoder step, viscous damping,
  /// dry friction, delay of the force and the time constant after it. 0: unknown or absent.
  double resolution_m = 0.0, damping_ns_per_m = 0.0, coulomb_friction_n = 0.0;
  double delay_s = 0.0, force_lag_s = 0.0;
};

/// Above this w0 T [rad] the sampled filter rings visibly and its cut-off deviates by more than 3
/// %; gives a warning.
inline constexpr double kWarnCutoffRad = 0.6;

/// One error or warning about a specification.
struct CouplingIssue {
  std::string field;     ///< member of CouplingSpec as spelled in scenes, or the argument's name
  std::string sentence;  ///< names field, value and rule
  bool refuse = true;    ///< false: a warning
};

/// Validates the parameters of `spec.kind` for a loop with period `sample_time_s` [s]. Empty:
/// valid.
std::vector<CouplingIssue> validate(const CouplingSpec& spec, const CouplingLimits& limits,
                                    double sample_time_s);

/// w0 of a shaping filter [rad/s].
double cutoff_rad_per_s(const CouplingSpec& spec) noexcept;
/// Whether injected damping uses a slow velocity within a band.
bool damps_on_slow_velocity(const CouplingSpec& spec) noexcept;
/// Low-frequency lag of the coupling [s]: 2 d / w0 for the shaping filter, 0 for the others (the
/// spring-damper leads).
double lag_s(const CouplingSpec& spec) noexcept;
/// Upper bound of the displayed stiffness for a contact of `contact_n_per_m`, at rest, in W. With k
/// the smaller of it and the cap, it is K k for the filter, c k / (c + k) for the spring-damper and
/// k for the direct coupling.
double displayed_stiffness_n_per_m(const CouplingSpec& spec, double contact_n_per_m) noexcept;

}  // namespace voxtouch::coupling
