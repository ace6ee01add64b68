#include "devices/sim/described.hpp"

namespace voxtouch::sim {

SimParameters simulated(const DeviceDescription& d) {
  SimParameters p = d.grip == "pen" ? sim_phantom() : sim_lwr();  // for what follows from the class
  const double turning_step_rad = p.description.orientation_resolution_rad;
  p.description = d;
  p.mass_kg = Vec3(d.mass_max_kg, 0.5 * (d.mass_min_kg + d.mass_max_kg), d.mass_min_kg);
  if (d.max_torque_nm > 0.0) {
    p.inertia_kg_m2 = d.inertia_min_kg_m2;
    p.damping_nms_per_rad = d.damping_nms_per_rad;
    p.coulomb_friction_nm = d.coulomb_friction_nm;
  } else {
    p.description.orientation_resolution_rad = turning_step_rad;
  }
  return p;
}

}  // namespace voxtouch::sim
