#include "core/scene/device_check.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/coupling/coupling_spec.hpp"
#include "core/scene/design_request.hpp"

namespace voxtouch {

namespace {

/// What a person would lower first.
std::string stiffest(const Scene& scene) {
  double most = scene.contact.stiffness_n_per_m;
  std::string what = "contact.stiffness_n_per_m";
  for (const EffectSpec& effect : scene.effects)
    if (const double own = bound_of(effect).stiffness_n_per_m; own > most)
      most = own, what = fmt::format("the effect '{}'{}{}{} ({:.4g} N/m)", effect.name, effect.place.empty() ? "" : " (", effect.place, effect.place.empty() ? "" : ")", own);
  return what;
}

}  // namespace

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

double least_stiffness_n_per_m(const Scene& scene) noexcept {
  double sum = scene.contact.stiffness_n_per_m;
  for (const EffectSpec& effect : scene.effects) {
    const double own = bound_of(effect).stiffness_n_per_m;
    if (effect.kind->needs(effect.values).body) return own;
    sum += own;
  }
  return sum;
}

std::string effects_damp_too_much(const Scene& scene, const CouplingSpec& spec, const LateDamping& device) {
  double sum = 0.0, most = 0.0;
  const EffectSpec* largest = nullptr;
  for (const EffectSpec& effect : scene.effects) {
    if (effect.kind->needs(effect.values).body) continue;  // damps against the body, which gives way
    const double own = bound_of(effect).damping_ns_per_m;
    sum += own;
    if (own > most) most = own, largest = &effect;
  }
  const double at_hand = sum * hand_scales(scene.device).translation, late_s = lag_s(spec) + device.delay_s;
  const double limit = 0.25 * std::numbers::pi * device.mass_kg / late_s;
  if (largest == nullptr || at_hand <= limit) return {};
  return fmt::format("{}{}the effects damp with up to {:.3g} Ns/m at the hand, '{}' most of it. The force is {:.3g} ms late, and a "
                     "device of {:.3g} kg let go stands {:.3g} Ns/m with a margin of 2: lower it below {:.3g} Ns/m.",
                     largest->place, largest->place.empty() ? "" : ": ", at_hand, largest->name, 1e3 * late_s,
                     device.mass_kg, limit, most * limit / at_hand);
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
                                     "device can show {:.4g} N/m. Lower {} by a factor of {:.3g}, or the "
                                     "coupling's gain, or a scale of the device.",
                                     stiffness_bound_n_per_m, felt, device.max_stiffness_n_per_m, stiffest(scene),
                                     felt / device.max_stiffness_n_per_m));
  const CouplingLimits limits =
      limits_in_world(scene.device, device.max_force_n, std::numeric_limits<double>::infinity());
  for (const CouplingIssue& issue : validate(scene.coupling, limits, device.sample_time_s))
    (issue.refuse ? out.errors : out.warnings).push_back("Coupling: " + issue.sentence);
  return out;
}

}  // namespace voxtouch
