#pragma once
/// One effect of each kind that needs no scene, and the invariants after any change.
#include <array>
#include <string>
#include <vector>

#include "core/effects/effect_chain.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace voxtouch::fuzz {

inline std::vector<effects::EffectSpec> all_effects() {
  std::vector<effects::EffectSpec> all;
  for (const effects::EffectKind* kind : effects::effect_kinds()) {
    effects::EffectSpec spec;
    spec.name = kind->name, spec.kind = kind;
    spec.values = effects::EffectValues(kind->parameters);
    for (std::size_t n = 0; n < kind->parameters.size(); ++n) {
      const effects::EffectParameter& p = kind->parameters[n];
      if (p.standard)
        continue;
      const double some = std::isfinite(p.high) ? 0.5 * (p.low + p.high) : p.low + 0.1;
      spec.values.at(n) =
          p.shape == effects::ParameterShape::kDirection ? std::array{0.0, 0.0, 1.0}
          : p.shape == effects::ParameterShape::kWord || p.shape == effects::ParameterShape::kText
              ? std::array{0.0, 0.0, 0.0}
              : std::array{some, 0.0, 0.0};
    }
    const effects::EffectNeeds needs = kind->needs(spec.values);
    if (!effects::check_values(*kind, spec.values).empty() || needs.body || needs.proximity_m > 0.0)
      continue;
    all.push_back(std::move(spec));
  }
  return all;
}

inline void require_good(const effects::EffectSpec& effect) {
  FUZZ_REQUIRE(effects::check_values(*effect.kind, effect.values).empty());
  FUZZ_REQUIRE(effect.gain >= 0.0 && effect.gain <= 1.0);
  const effects::EffectBound bound = effects::bound_of(effect);
  FUZZ_REQUIRE(std::isfinite(bound.stiffness_n_per_m) && std::isfinite(bound.stiffness_nm_per_rad));
}

}  // namespace voxtouch::fuzz
