#pragma once
/// What a device says of itself, as the designer of couplings reads it.
#include "core/coupling/design/loop_parts.hpp"

namespace voxtouch::runtime {

/// `Description`: the message, or the driver's struct; their fields have the same names. A real device's command leaves a period
/// after its sample at the latest; a simulated one applies it within the sample's own period.
template <class Description>
DeviceModel model_of(const Description& d, bool simulated) {
  DeviceModel m;
  m.name = d.model;
  m.translation = {.inertia_min = d.mass_min_kg,
                   .inertia_max = d.mass_max_kg,
                   .damping = d.damping_ns_per_m,
                   .coulomb_friction = d.coulomb_friction_n,
                   .resolution = d.position_resolution_m,
                   .max_effort = d.max_force_n,
                   .max_stiffness = d.max_stiffness_n_per_m,
                   .effort_bandwidth_hz = d.force_bandwidth_hz};
  m.gives_torque = d.max_torque_nm > 0.0;
  m.rotation = {.inertia_min = d.inertia_min_kg_m2,
                .inertia_max = d.inertia_max_kg_m2,
                .damping = d.damping_nms_per_rad,
                .coulomb_friction = d.coulomb_friction_nm,
                .resolution = d.orientation_resolution_rad,
                .max_effort = d.max_torque_nm,
                .max_stiffness = d.max_stiffness_nm_per_rad,
                .effort_bandwidth_hz = d.force_bandwidth_hz};
  m.timing.period_s = 1.0 / d.rate_hz;
  m.timing.delay_s = d.delay_s + (simulated ? 0.0 : m.timing.period_s);
  m.timing.jitter = d.jitter;
  m.timing.lost_in_a_row = static_cast<int>(d.lost_in_a_row);
  return m;
}

}  // namespace voxtouch::runtime
