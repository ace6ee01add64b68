#include "core/scene/device_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

namespace voxtouch::scene {
namespace {

// Standards lie at the end of the usual range that makes the design the more careful one.
constexpr auto kFigures = std::to_array<DeviceFigure>(
    {{"device", "a name", "a name", {}, {}, "It names the device in messages and summaries."},
     {"rate_hz",
      "500 to 4000 Hz",
      "200 to 1000 Hz",
      {},
      {},
      "A sample is held for a period: twice the rate lets a quarter to a half more stiffness "
      "hold."},
     {"max_force_n",
      "3 to 40 N",
      "20 to 200 N",
      {},
      {},
      "Commands are cut to it; the stiffness that holds does not depend on it."},
     {"max_torque_nm",
      "0 (three motors) to 0.5 Nm",
      "1 to 20 Nm",
      {},
      {},
      "Above 0 rotation is designed for too; 0 leaves it out."},
     {"max_stiffness_n_per_m",
      "300 to 5000 N/m",
      "1000 to 5000 N/m",
      {},
      {},
      "No more than this is requested of a design, whatever would hold."},
     {"mass_kg",
      "0.03 to 0.3 kg",
      "1 to 10 kg",
      {},
      {},
      "Apparent at the tool, a number or [least, most]: the least one decides when the device is "
      "released."},
     {"damping_ns_per_m", "0.005 to 1 Ns/m", "1 to 50 Ns/m", 0.005, 1.0,
      "Dissipation that the design may count on; too high a figure makes an unstable design look "
      "stable."},
     {"coulomb_friction_n", "0.01 to 1 N", "0.5 to 5 N", 0.0, 0.5,
      "Dry friction; it stops what the encoder's steps could leave, and nothing else is counted "
      "on."},
     {"position_resolution_m",
      "1e-6 to 1e-4 m",
      "1e-6 to 1e-4 m",
      {},
      {},
      "The encoder's step at the tool: damping in contact makes noise of it, which limits that "
      "damping."},
     {"delay_s", "0 to 0.002 s", "0.001 to 0.005 s", 0.001, 0.002,
      "From the sample to the force: every millisecond costs stiffness."},
     {"jitter", "0.05 to 0.5", "0.05 to 0.5", 0.2, 0.2,
      "The longest period is (1 + jitter) / rate_hz, and the design holds for it."},
     {"lost_in_a_row", "0 to 3", "0 to 3", 1.0, 1.0,
      "Samples that may be lost one after the other: each makes the worst delay a period longer."},
     {"grip",
      "pen",
      "arm",
      {},
      {},
      "The class: a stylus between the fingers, or an arm that hand and arm hold; it chooses the "
      "hands that are designed for."},
     {"inertia_kg_m2", "1e-5 to 1e-3 kg m^2", "0.01 to 0.5 kg m^2", 1e-4, 0.05,
      "About any axis at the tool, a number or [least, most]: the least one decides when it is "
      "released."},
     {"damping_nms_per_rad", "1e-4 to 1e-2 Nms/rad", "0.05 to 1 Nms/rad", 1e-4, 0.05,
      "As damping_ns_per_m, against rotation."},
     {"coulomb_friction_nm", "0 to 0.01 Nm", "0 to 0.5 Nm", 0.0, 0.0,
      "As coulomb_friction_n, against rotation."},
     {"orientation_resolution_rad", "1e-5 to 1e-3 rad", "1e-6 to 1e-3 rad", 1e-3, 1e-4,
      "As position_resolution_m, for rotation."},
     {"max_stiffness_nm_per_rad", "0.1 to 5 Nm/rad", "20 to 300 Nm/rad", 0.3, 100.0,
      "As max_stiffness_n_per_m, against rotation."}});

}  // namespace

const DeviceFigure& device_figure(std::string_view key) {
  const auto found = std::ranges::find(kFigures, key, &DeviceFigure::key);
  if (found == kFigures.end())
    throw std::logic_error(fmt::format("no device has a figure '{}'", key));
  return *found;
}

std::string to_sentence(const DeviceFigure& f) {
  const std::string usual =
      f.pen == f.arm ? std::string(f.pen) : fmt::format("{} (stylus), {} (arm)", f.pen, f.arm);
  return fmt::format("{}: {}. {}", f.key, usual, f.effect);
}

}  // namespace voxtouch::scene
