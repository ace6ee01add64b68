#pragma once
/// What makes one simulated device differ from another.
#include "devices/driver.hpp"
#include "devices/sim/operator.hpp"

namespace voxtouch::sim {

/// A plant whose mass is the same in every pose and diagonal in D. What the device reports about
/// itself (limits, damping, friction, resolution, delay, force lag) is what it is simulated with.
struct SimParameters {
  DeviceDescription description;
  Vec3 mass_kg = Vec3::Ones();  ///< along the axes of D
  double inertia_kg_m2 = 1e-3;  ///< about any axis
  double damping_nms_per_rad = 0.0;
  double coulomb_friction_nm = 0.0;
  double velocity_filter_hz = 50.0;  ///< first-order low-pass of the reported twist
  OperatorConfig hand;               ///< how such a device is usually held
};

/// A Phantom Premium 1.5 with an encoder gimbal: six sensed, three driven degrees of freedom. Held
/// like a pen.
SimParameters sim_phantom();
/// A light-weight robot used as hand controller under torque control: six driven degrees of
/// freedom. Held by an arm.
SimParameters sim_lwr();

/// A device that is known by its description alone. What that does not say is assumed: the mass is
/// the largest along x of D and the least along z, where most scenes press; a device without torque
/// turns like its class; the twist passes 50 Hz; the hand is that of `sim-phantom` or `sim-lwr`, by
/// the grip.
SimParameters simulated(const DeviceDescription& description);

}  // namespace voxtouch::sim
