#pragma once
/// What a haptic device is: one value from which its messages, the designer's model, the guard and
/// all limits are made.
#include <cstdint>
#include <string>

namespace voxtouch {

/// What the device is: the numbers that guard, coupling and people need. "No limit" is infinity.
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
  std::string grip = "pen";  ///< how it is usually held: "pen" or "arm"
  std::uint32_t input_dof = 6, output_dof = 3;
  bool simulated = false;  ///< its command acts within the sample's own period; a real device's may
                           ///< leave a period later
};

/// Speeds that a hand moves a device with at most [m/s, rad/s].
inline constexpr double kFastestHandMPerS = 3.0, kFastestHandRadPerS = 30.0;
/// Seconds in which the guard brings a force back after a fade.
inline constexpr double kReturnRampS = 0.1;

/// The slew limits, of the device's other numbers: no certified loop asks for more, so a command
/// that does is a fault.
///
///     K v + F / T + F / kReturnRampS
///
/// The first is a wall of the largest stiffness met at the hand's largest speed; the second the
/// injected damper, which never pulls and is cut to the device's force, so that it comes or goes
/// with a step of at most F within a period; the third the guard's own ramp. Real-time safe.
void derive_slew_limits(DeviceDescription& device) noexcept;

/// The first number that cannot be a device's, as a sentence; empty where all can. It cannot know
/// whether the numbers are true. One check for whoever opens a device and for every receiver of
/// one. Allocates: not for the loop.
std::string validate(const DeviceDescription& device);

}  // namespace voxtouch
