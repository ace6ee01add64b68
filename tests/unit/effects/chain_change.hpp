#pragma once
/// A change of an effect chain by name, validated and applied as in a running scene.
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/effects/effect_chain.hpp"
#include "core/effects/effect_change.hpp"

namespace voxtouch::test {

/// Why `request` cannot be; empty if it was done.
inline std::string change(effects::EffectChain& chain, const effects::EffectRequest& request) {
  std::vector<effects::EffectSpec> effects;
  for (std::size_t i = 0; i < chain.size(); ++i)
    effects.push_back(chain.spec(i));
  const auto judged = effects::judge(effects, request);
  if (!judged)
    return judged.error();
  chain.carry_out(*judged);
  return {};
}

/// The same for one parameter of the chain's first effect.
inline std::string set_value(effects::EffectChain& chain, std::string_view parameter,
                             const std::array<double, 3>& value) {
  return change(chain, {.action = effects::EffectAction::kValue,
                        .effect = chain.spec(0).name,
                        .parameter = parameter,
                        .value = value});
}

}  // namespace voxtouch::test
