#include "core/effects/effect_spec.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace voxtouch::effects {

EffectNeeds needs_of(std::span<const EffectSpec> effects) {
  EffectNeeds all;
  for (const EffectSpec& spec : effects) {
    const EffectNeeds one = spec.kind->needs(spec.values);
    all.twist |= one.twist, all.contact |= one.contact, all.torque |= one.torque,
        all.orientation |= one.orientation;
    all.body |= one.body, all.external |= one.external;
    all.proximity_m = std::max(all.proximity_m, one.proximity_m);
    all.smoothing_m = std::max(all.smoothing_m, one.smoothing_m),
    all.lever_m = std::min(all.lever_m, one.lever_m);
  }
  return all;
}

const EffectSpec* external_of(std::span<const EffectSpec> effects) {
  const auto found = std::find_if(effects.begin(), effects.end(), [](const EffectSpec& e) {
    return e.kind->needs(e.values).external;
  });
  return found == effects.end() ? nullptr : &*found;
}

std::string no_certificate_sentence(std::string_view name) {
  return fmt::format(
      "Effect '{}' is not certified: the writer of its topic may react to the pose. Its force, "
      "slew rate and energy are limited.",
      name);
}

EffectBound bound_of(const EffectSpec& effect) {
  EffectBound bound = effect.kind->bound(effect.values);
  const double slope = slope_bound_per_m(effect.region);
  if (slope <= 0.0)
    return bound;  // everywhere: avoids 0 times infinity
  if (effect.kind->energy == EnergyBehaviour::kConservative) {
    bound.stiffness_n_per_m +=
        2.0 * slope * bound.force_n + curvature_bound_per_m2(effect.region) * bound.potential_j;
    bound.force_n += slope * bound.potential_j;
  } else {
    bound.stiffness_n_per_m += slope * bound.force_n;
  }
  return bound;
}

}  // namespace voxtouch::effects
