#include "devices/sim/parameters.hpp"

#include <fmt/format.h>

#include <numbers>
#include <stdexcept>
#include <string_view>

#include "devices/operator/hand.hpp"

namespace voxtouch::sim {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void require(bool good, std::string_view field, double value, std::string_view rule) {
  if (!good)
    throw std::runtime_error(
        fmt::format("simulated device: {} is {}; it must be {}", field, value, rule));
}
void require_in(double value, double low, double high, std::string_view field) {
  require(value >= low && value <= high, field, value, fmt::format("in [{}, {}]", low, high));
}

}  // namespace

// Sources of the numbers. "confirmed": read in a published source. "derived": computed from
// confirmed values. "assumed": no source found; a default, not a fact about the hardware.

SimParameters sim_phantom() {
  SimParameters p;
  DeviceDescription& d = p.description;
  d.model = "sim-phantom";
  d.rate_hz = 1000.0;     // confirmed: servo rate
  d.max_force_n = 8.5;    // confirmed in CHAI3D's model table
  d.max_torque_nm = 0.0;  // confirmed: three motors
  // Confirmed in CHAI3D's table; stable walls were measured at 300 to 900 N/m. The 3500 N/m of data
  // sheets is the stiffness of the structure, and assumed.
  d.max_stiffness_n_per_m = 800.0;
  d.mass_min_kg = 0.035;  // derived from a published link model over the workspace
  d.mass_max_kg = 0.08;
  d.damping_ns_per_m = 0.005;         // assumed: hardly any
  d.coulomb_friction_n = 0.04;        // assumed (data sheet); agrees with 0.01 Nm a joint, derived
  d.position_resolution_m = 0.03e-3;  // assumed (data sheet)
  d.delay_s = 0.001;                  // derived: one servo tick
  d.force_bandwidth_hz = kInfinity;   // assumed: faster than the servo loop
  d.orientation_resolution_rad = 1e-3;  // assumed, of the gimbal
  d.grip = "pen";
  d.input_dof = 6;
  d.output_dof = 3;
  p.mass_kg = Vec3::Constant(0.075);  // derived: upper end of the range, sideways at the reset pose
  p.inertia_kg_m2 = 1e-4;             // this and the rest of the gimbal: assumed
  p.damping_nms_per_rad = 1e-3;
  p.coulomb_friction_nm = 0.0;
  p.velocity_filter_hz = 50.0;  // assumed: a vendor's smoothing is not published
  p.hand = *hand::grip("pen");
  derive_slew_limits(d);
  return p;
}

SimParameters sim_lwr() {
  SimParameters p;
  DeviceDescription& d = p.description;
  d.model = "sim-lwr";
  d.rate_hz = 1000.0;      // confirmed: fastest rate of the remote interface
  d.max_force_n = 150.0;   // assumed; joint torques would allow 200 N and more, derived
  d.max_torque_nm = 15.0;  // assumed: half of the wrist joints' torque
  // Confirmed: cap of the Cartesian stiffness in published drivers.
  d.max_stiffness_n_per_m = 5000.0;
  d.mass_min_kg = 3.0;  // derived from an identified model, motor inertia divided by four
  d.mass_max_kg = 6.0;
  d.damping_ns_per_m = 30.0;        // assumed
  d.coulomb_friction_n = 3.0;       // assumed residual of the torque control
  d.position_resolution_m = 20e-6;  // assumed
  d.delay_s = 0.002;                // assumed, like the lag
  d.force_bandwidth_hz = 1.0 / (2.0 * std::numbers::pi * 0.003);
  d.inertia_min_kg_m2 = 0.1;  // derived from assumed motor inertia of the wrist, divided by four
  d.inertia_max_kg_m2 = 0.1;
  d.damping_nms_per_rad = 0.3;          // confirmed as a published model's value of joint 6
  d.coulomb_friction_nm = 0.1;          // assumed residual of the torque control
  d.orientation_resolution_rad = 1e-4;  // assumed
  // Assumed: cap of the rotational stiffness in published drivers.
  d.max_stiffness_nm_per_rad = 300.0;
  d.grip = "arm";
  d.input_dof = 6;
  d.output_dof = 6;
  // Derived: elbow bent, orientation free, motor inertia divided by four.
  p.mass_kg = Vec3(6.0, 3.9, 5.5);
  p.inertia_kg_m2 = 0.1;        // derived from assumed motor inertia of the wrist, divided by four
  p.damping_nms_per_rad = 0.3;  // confirmed as a published model's value of joint 6
  p.coulomb_friction_nm = 0.1;  // assumed
  p.velocity_filter_hz = 50.0;  // assumed
  p.hand = *hand::grip("arm");
  derive_slew_limits(d);
  return p;
}

void OperatorConfig::validate() const {
  require(release_time_s >= 0.0, "release_time_s", release_time_s, ">= 0 (infinity: never)");
  require(grip_change_time_s >= 0.0, "grip_change_time_s", grip_change_time_s,
          ">= 0 (infinity: never)");
  require_in(grip_factor, 1e-3, 1e3, "grip_factor");
  require_in(mass_kg, 0.0, 1e3, "hand mass_kg");
  require_in(damping_ns_per_m, 0.0, 1e6, "hand damping_ns_per_m");
  require_in(stiffness_n_per_m, 0.0, 1e7, "hand stiffness_n_per_m");
  require_in(inertia_kg_m2, 0.0, 1e3, "hand inertia_kg_m2");
  require_in(damping_nms_per_rad, 0.0, 1e6, "hand damping_nms_per_rad");
  require_in(stiffness_nm_per_rad, 0.0, 1e6, "hand stiffness_nm_per_rad");
  require_in(tremor_n, 0.0, 1e3, "hand tremor_n");
  require_in(tremor_bandwidth_hz, 1e-3, 1e3, "hand tremor_bandwidth_hz");
}

SimParameters simulated(const DeviceDescription& d) {
  SimParameters p = d.grip == "pen" ? sim_phantom() : sim_lwr();  // defaults of the class
  const double rotation_step_rad = p.description.orientation_resolution_rad;
  p.description = d;
  p.mass_kg = Vec3(d.mass_max_kg, 0.5 * (d.mass_min_kg + d.mass_max_kg), d.mass_min_kg);
  if (d.max_torque_nm > 0.0) {
    p.inertia_kg_m2 = d.inertia_min_kg_m2;
    p.damping_nms_per_rad = d.damping_nms_per_rad;
    p.coulomb_friction_nm = d.coulomb_friction_nm;
  } else {
    p.description.orientation_resolution_rad = rotation_step_rad;
  }
  return p;
}

}  // namespace voxtouch::sim
