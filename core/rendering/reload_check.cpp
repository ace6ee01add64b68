#include "core/rendering/reload_check.hpp"

#include <algorithm>
#include <optional>

namespace voxtouch::rendering {
namespace {

/// Whether the file specifies the same effect, at any position.
bool same(const effects::EffectSpec& a, const effects::EffectSpec& b) {
  return a.name == b.name && a.kind == b.kind && a.values == b.values && a.gain == b.gain &&
         a.on == b.on && a.text == b.text && a.object == b.object && a.region == b.region;
}

/// Topic of the external wrench; empty if no effect uses one.
std::optional<std::string> topic_of(const scene::Scene& scene) {
  const effects::EffectSpec* effect = effects::external_of(scene.effects);
  return effect ? std::optional(effect->text) : std::nullopt;
}

}  // namespace

std::string reload_refusal(const scene::Scene& running, const scene::Scene& next) {
  if (running.device != next.device)
    return "the scene's 'device' section changed, which needs a restart of the ring";
  if (running.design != next.design || running.coupling != next.coupling)
    return "the scene's 'coupling' section changed, which needs a restart of the ring";
  if (effects::needs_of(running.effects).body || effects::needs_of(next.effects).body)
    return "the scene has effect 'body', whose pose a reload cannot keep: restart the ring";
  if (topic_of(running) != topic_of(next))
    return "effect 'external' or its topic changed, which needs a restart of the ring";
  return {};
}

std::vector<effects::EffectSpec> carried_over(std::span<const effects::EffectSpec> before,
                                              std::span<const effects::EffectSpec> now,
                                              std::span<const effects::EffectSpec> next) {
  std::vector<effects::EffectSpec> effects(next.begin(), next.end());
  for (effects::EffectSpec& effect : effects) {
    const auto old = std::find_if(before.begin(), before.end(),
                                  [&](const effects::EffectSpec& e) { return same(e, effect); });
    if (old != before.end())
      effect = now[static_cast<std::size_t>(old - before.begin())];
  }
  return effects;
}

}  // namespace voxtouch::rendering
