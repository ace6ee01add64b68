#include "core/scene/device_check.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/coupling/coupling_spec.hpp"
#include "core/scene/design_request.hpp"

namespace voxtouch {

double stiffness_at_hand_n_per_m(const Scene& scene, double stiffness_bound_n_per_m) noexcept {
  const double capped = std::min(stiffness_bound_n_per_m, scene.coupling.stiffness_cap_n_per_m);
  return displayed_stiffness_n_per_m(scene.coupling, capped) * hand_scales(scene.device).translation;
}

std::vector<std::string> effects_not_shown(const Scene& scene, bool gives_torque) {
  std::vector<std::string> out;
  if (gives_torque) return out;
  for (const EffectSpec& effect : scene.effects)
    if (effect.kind->needs(effect.values).torque)
      out.push_back(fmt::format(
          "The effect '{}' gives torque, and the device gives none. Leave the effect out, set what turns the tool to 0, or use "
          "a device of six degrees of freedom.",
          effect.name));
  return out;
}

DeviceCheck check_device(const Scene& scene, const DeviceFacts& device, double stiffness_bound_n_per_m) {
  DeviceCheck out;
  if (!(stiffness_bound_n_per_m >= 0.0) || !std::isfinite(stiffness_bound_n_per_m)) {
    out.errors.push_back(fmt::format("The scene's stiffness bound is {} N/m, which is no stiffness.", stiffness_bound_n_per_m));
    return out;
  }
  if (!(device.max_stiffness_n_per_m > 0.0))
    out.errors.push_back(fmt::format("The device gives a largest stiffness of {} N/m; it must be above 0.",
                                     device.max_stiffness_n_per_m));
  const double felt = stiffness_at_hand_n_per_m(scene, stiffness_bound_n_per_m);
  // Written so that NaN does not pass.
  if (device.max_stiffness_n_per_m > 0.0 && !(felt <= device.max_stiffness_n_per_m))
    out.errors.push_back(fmt::format("The contact's {:.4g} N/m are {:.4g} N/m at the hand; the "
                                     "device can show {:.4g} N/m. Lower contact.stiffness_n_per_m below {:.4g}, or the "
                                     "coupling's gain, or a scale of the device.",
                                     stiffness_bound_n_per_m, felt, device.max_stiffness_n_per_m,
                                     scene.contact.stiffness_n_per_m * device.max_stiffness_n_per_m / felt));
  const CouplingLimits limits =
      limits_in_world(scene.device, device.max_force_n, std::numeric_limits<double>::infinity());
  for (const CouplingIssue& issue : validate(scene.coupling, limits, device.sample_time_s))
    (issue.refuse ? out.errors : out.warnings).push_back("Coupling: " + issue.sentence);
  return out;
}

}  // namespace voxtouch
