#pragma once
/// Description of a haptic device, from which messages, the designer's model, the guard and all
/// limits are derived.
#include <cstdint>
#include <string>

namespace voxtouch {

/// Properties of a device for guard, coupling and operators. Infinity: no limit.
struct DeviceDescription {
  std::string model;  ///< for example "sim-phantom"
  double rate_hz = 1000.0;
  double max_force_n = 0.0;
  double max_torque_nm = 0.0;           ///< 0: gives no torque
  double max_force_rate_n_per_s = 0.0;  ///< slew limit that the guard keeps; see derive_slew_limits
  double max_torque_rate_nm_per_s = 0.0;
  double max_stiffness_n_per_m = 0.0;
  double mass_min_kg = 0.0, mass_max_kg = 0.0;  ///< apparent mass at the tool over the workspace
  double damping_ns_per_m = 0.0;
  double coulomb_friction_n = 0.0;
  double position_resolution_m = 0.0;
  double delay_s = 0.0;  ///< from command to force, excluding the sample period
  double network_delay_s =
      0.0;  ///< of the network between device and coupling, there and back, in addition to delay_s
  double force_bandwidth_hz =
      0.0;  ///< first-order lag of the force and the torque; infinity if none
  double inertia_min_kg_m2 = 0.0,
         inertia_max_kg_m2 = 0.0;  ///< about any axis at the tool; 0 without torque
  double damping_nms_per_rad = 0.0;
  double coulomb_friction_nm = 0.0;
  double orientation_resolution_rad = 0.0;
  double max_stiffness_nm_per_rad = 0.0;  ///< 0 without torque
  double jitter = 0.2;                    ///< the longest sample period is (1 + jitter) / rate_hz
  std::uint32_t consecutive_losses =
      1;                     ///< samples or commands that may be lost one after the other
  std::string grip = "pen";  ///< usual grip: "pen" or "arm"
  std::uint32_t input_dof = 6, output_dof = 3;
  bool simulated = false;  ///< a command acts within its sample's period; on a real device possibly
                           ///< a period later
};

/// Speeds that a hand moves a device with at most [m/s, rad/s].
inline constexpr double kFastestHandMPerS = 3.0, kFastestHandRadPerS = 30.0;
/// Seconds in which the guard brings a force back after a fade.
inline constexpr double kReturnRampS = 0.1;

/// Derives the slew limits from the other properties. No certified loop exceeds them, so a command
/// that does is a fault.
///
///     K v + F / T + F / kReturnRampS
///
/// The first term is a wall of the largest stiffness met at the hand's largest speed. The second is
/// the injected damper, which never pulls and is limited to the device's force: it changes by at
/// most F within a period. The third is the guard's ramp. Real-time safe.
void derive_slew_limits(DeviceDescription& device) noexcept;

/// The first impossible value, as a sentence; empty if there is none. It cannot detect wrong but
/// plausible values. Callers that open a device and receivers of a description use the same check.
/// Allocates: not for the loop.
std::string validate(const DeviceDescription& device);

}  // namespace voxtouch
