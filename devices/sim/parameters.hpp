#pragma once
/// Parameters of a simulated device.
#include "devices/driver.hpp"
#include "devices/sim/operator.hpp"

namespace voxtouch::sim {

/// A plant with the same mass in every pose, diagonal in D. It is simulated with the limits,
/// damping, friction, resolution, delay and force lag that the device reports.
struct SimParameters {
  DeviceDescription description;
  Vec3 mass_kg = Vec3::Ones();  ///< along the axes of D
  double inertia_kg_m2 = 1e-3;  ///< about any axis
  double damping_nms_per_rad = 0.0;
  double coulomb_friction_nm = 0.0;
  double velocity_filter_hz = 50.0;  ///< first-order low-pass of the reported twist
  OperatorConfig hand;               ///< usual grip of such a device
};

/// A Phantom Premium 1.5 with an encoder gimbal: 6 sensed, 3 actuated degrees of freedom. Held like
/// a pen.
SimParameters sim_phantom();
/// A light-weight robot under torque control: 6 actuated degrees of freedom. Held by an arm.
SimParameters sim_lwr();

/// A device that is known by its description only. Assumed: the mass is largest along x of D and
/// smallest along z, in which most scenes press; without torque, the rotation is that of the class;
/// the twist has a bandwidth of 50 Hz; the hand is that of `sim-phantom` or `sim-lwr`, by the grip.
SimParameters simulated(const DeviceDescription& description);

}  // namespace voxtouch::sim
