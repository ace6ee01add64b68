#pragma once
/// Converts a device description to a message and back.
#include "core/types/device_description.hpp"
#include "nodes/runtime/strings.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::runtime {

/// Copies the fields that have the same name in message and value.
template <class From, class To>
void copy_device_numbers(const From& from, To& to) noexcept {
  to.rate_hz = from.rate_hz;
  to.max_force_n = from.max_force_n;
  to.max_torque_nm = from.max_torque_nm;
  to.max_force_rate_n_per_s = from.max_force_rate_n_per_s;
  to.max_torque_rate_nm_per_s = from.max_torque_rate_nm_per_s;
  to.max_stiffness_n_per_m = from.max_stiffness_n_per_m;
  to.mass_min_kg = from.mass_min_kg;
  to.mass_max_kg = from.mass_max_kg;
  to.damping_ns_per_m = from.damping_ns_per_m;
  to.coulomb_friction_n = from.coulomb_friction_n;
  to.position_resolution_m = from.position_resolution_m;
  to.delay_s = from.delay_s;
  to.network_delay_s = from.network_delay_s;
  to.force_bandwidth_hz = from.force_bandwidth_hz;
  to.inertia_min_kg_m2 = from.inertia_min_kg_m2;
  to.inertia_max_kg_m2 = from.inertia_max_kg_m2;
  to.damping_nms_per_rad = from.damping_nms_per_rad;
  to.coulomb_friction_nm = from.coulomb_friction_nm;
  to.orientation_resolution_rad = from.orientation_resolution_rad;
  to.max_stiffness_nm_per_rad = from.max_stiffness_nm_per_rad;
  to.jitter = from.jitter;
  to.consecutive_losses = from.consecutive_losses;
  to.input_dof = from.input_dof;
  to.output_dof = from.output_dof;
  to.simulated = from.simulated;
}

/// The texts refer to `device`, which must outlive the message. The caller sets session and mode.
inline msg::DeviceDescription to_msg(const DeviceDescription& device) noexcept {
  msg::DeviceDescription m{};
  copy_device_numbers(device, m);
  m.model = lend(device.model);
  m.grip = lend(device.grip);
  return m;
}

/// Copies all values unchecked; `validate` checks them.
inline DeviceDescription from_msg(const msg::DeviceDescription& m) {
  DeviceDescription device;
  copy_device_numbers(m, device);
  device.model = m.model ? m.model : "";
  device.grip = m.grip ? m.grip : "";
  return device;
}

}  // namespace voxtouch::runtime
