#include "core/scene/device_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

namespace voxtouch::scene {
namespace {

// Standards lie at the end of the usual range that makes the design the more careful one.
constexpr auto kFigures = std::to_array<DeviceFigure>(
    {{"device", "a name", "a name", {}, {}, "Name of the device in messages and summaries."},
     {"rate_hz",
      "500 to 4000 Hz",
      "200 to 1000 Hz",
      {},
      {},
      "Sample rate. Doubling it allows a quarter to a half more stiffness."},
     {"max_force_n",
      "3 to 40 N",
      "20 to 200 N",
      {},
      {},
      "Commands are clamped to it; it does not affect the certified stiffness."},
     {"max_torque_nm",
      "0 (three motors) to 0.5 Nm",
      "1 to 20 Nm",
      {},
      {},
      "Above 0 the design includes rotation; 0: no torque."},
     {"max_stiffness_n_per_m",
      "300 to 5000 N/m",
      "1000 to 5000 N/m",
      {},
      {},
      "Upper limit of the stiffness that a design requests."},
     {"mass_kg",
      "0.03 to 0.3 kg",
      "1 to 10 kg",
      {},
      {},
      "Apparent mass at the tool, a number or [low, high]; the lowest decides when the device is "
      "released."},
     {"damping_ns_per_m", "0.005 to 1 Ns/m", "1 to 50 Ns/m", 0.005, 1.0,
      "Guaranteed viscous damping; too high a value makes an unstable design look stable."},
     {"coulomb_friction_n", "0.01 to 1 N", "0.5 to 5 N", 0.0, 0.5,
      "Dry friction; used only to bound limit cycles of encoder quantisation."},
     {"position_resolution_m",
      "1e-6 to 1e-4 m",
      "1e-6 to 1e-4 m",
      {},
      {},
      "Encoder step at the tool; its noise limits the injected damping."},
     {"delay_s", "0 to 0.002 s", "0.001 to 0.005 s", 0.001, 0.002,
      "Latency from sample to force; each millisecond costs stiffness."},
     {"jitter", "0.05 to 0.5", "0.05 to 0.5", 0.2, 0.2,
      "The design covers periods of up to (1 + jitter) / rate_hz."},
     {"consecutive_losses", "0 to 3", "0 to 3", 1.0, 1.0,
      "Consecutive sample losses; each adds a period to the worst delay."},
     {"grip",
      "pen",
      "arm",
      {},
      {},
      "Device class, stylus (pen) or arm; it selects the hands that the design covers."},
     {"inertia_kg_m2", "1e-5 to 1e-3 kg m^2", "0.01 to 0.5 kg m^2", 1e-4, 0.05,
      "About any axis at the tool, a number or [low, high]; the lowest decides when the device is "
      "released."},
     {"damping_nms_per_rad", "1e-4 to 1e-2 Nms/rad", "0.05 to 1 Nms/rad", 1e-4, 0.05,
      "As damping_ns_per_m, for rotation."},
     {"coulomb_friction_nm", "0 to 0.01 Nm", "0 to 0.5 Nm", 0.0, 0.0,
      "As coulomb_friction_n, for rotation."},
     {"orientation_resolution_rad", "1e-5 to 1e-3 rad", "1e-6 to 1e-3 rad", 1e-3, 1e-4,
      "As position_resolution_m, for rotation."},
     {"max_stiffness_nm_per_rad", "0.1 to 5 Nm/rad", "20 to 300 Nm/rad", 0.3, 100.0,
      "As max_stiffness_n_per_m, for rotation."}});

}  // namespace

const DeviceFigure& device_figure(std::string_view key) {
  const auto found = std::ranges::find(kFigures, key, &DeviceFigure::key);
  if (found == kFigures.end())
    throw std::logic_error(fmt::format("unknown device key '{}'", key));
  return *found;
}

std::string to_sentence(const DeviceFigure& f) {
  const std::string usual =
      f.pen == f.arm ? std::string(f.pen) : fmt::format("{} (stylus), {} (arm)", f.pen, f.arm);
  return fmt::format("{}: {}. {}", f.key, usual, f.effect);
}

}  // namespace voxtouch::scene
