#include "core/types/device_description.hpp"

#include <limits>
#include <string_view>

#include <fmt/format.h>

namespace voxtouch {

void derive_slew_limits(DeviceDescription& d) noexcept {
  const double steps = d.rate_hz + 1.0 / kReturnRampS;
  d.max_force_rate_n_per_s = d.max_stiffness_n_per_m * kFastestHandMPerS + d.max_force_n * steps;
  d.max_torque_rate_nm_per_s =
      d.max_stiffness_nm_per_rad * kFastestHandRadPerS + d.max_torque_nm * steps;
}

std::string validate(const DeviceDescription& d) {
  constexpr double kNoLimit = std::numeric_limits<double>::infinity();
  constexpr double kMostRate = 1e15;  // finite: values derived from an overflow are not
  std::string wrong;
  const auto within = [&](std::string_view name, double value, double least, double most) {
    if (wrong.empty() && !(value >= least && value <= most))  // NaN is not within
      wrong = fmt::format("the device's {} is {:g}, limits {:g} to {:g}", name, value, least, most);
  };
  const bool gives_torque = d.max_torque_nm > 0.0;
  within("rate_hz", d.rate_hz, 10.0, 100'000.0);
  within("max_force_n", d.max_force_n, 1e-3, 10'000.0);
  within("max_torque_nm", d.max_torque_nm, 0.0, 10'000.0);
  within("max_force_rate_n_per_s", d.max_force_rate_n_per_s, 1e-3, kMostRate);
  within("max_torque_rate_nm_per_s", d.max_torque_rate_nm_per_s, gives_torque ? 1e-3 : 0.0,
         kMostRate);
  within("max_stiffness_n_per_m", d.max_stiffness_n_per_m, 1e-3, 1e7);
  within("max_stiffness_nm_per_rad", d.max_stiffness_nm_per_rad, 0.0, 1e7);
  within("mass_min_kg", d.mass_min_kg, 1e-4, 1'000.0);
  within("mass_max_kg", d.mass_max_kg, d.mass_min_kg, 1'000.0);
  within("inertia_min_kg_m2", d.inertia_min_kg_m2, gives_torque ? 1e-9 : 0.0, 1'000.0);
  within("inertia_max_kg_m2", d.inertia_max_kg_m2, d.inertia_min_kg_m2, 1'000.0);
  within("damping_ns_per_m", d.damping_ns_per_m, 0.0, 10'000.0);
  within("damping_nms_per_rad", d.damping_nms_per_rad, 0.0, 10'000.0);
  within("coulomb_friction_n", d.coulomb_friction_n, 0.0, 10'000.0);
  within("coulomb_friction_nm", d.coulomb_friction_nm, 0.0, 10'000.0);
  within("position_resolution_m", d.position_resolution_m, 0.0, 0.1);
  within("orientation_resolution_rad", d.orientation_resolution_rad, 0.0, 1.0);
  within("delay_s", d.delay_s, 0.0, 1.0);
  within("network_delay_s", d.network_delay_s, 0.0, 0.1);
  within("force_bandwidth_hz", d.force_bandwidth_hz, 1e-3, kNoLimit);
  within("jitter", d.jitter, 0.0, 100.0);
  within("consecutive_losses", d.consecutive_losses, 0.0, 1'000.0);
  if (wrong.empty() && d.grip != "pen" && d.grip != "arm")
    wrong = "the device's grip must be pen or arm";
  return wrong;
}

}  // namespace voxtouch
