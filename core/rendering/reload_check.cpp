#include "core/rendering/reload_check.hpp"

#include <algorithm>

namespace voxtouch {
namespace {

/// As the file asks for it, wherever it stands there.
bool same(const EffectSpec& a, const EffectSpec& b) {
  return a.name == b.name && a.kind == b.kind && a.values == b.values && a.gain == b.gain && a.on == b.on &&
         a.object == b.object && a.region == b.region;
}

}  // namespace

std::string why_not_reloaded(const Scene& running, const Scene& next) {
  if (running.device != next.device)
    return "the scene's 'device' section has changed, which the device and coupling nodes do not read again: restart the "
           "ring for it";
  if (running.design != next.design || running.coupling != next.coupling)
    return "the scene's 'coupling' section has changed, which the coupling node does not read again: restart the ring "
           "for it";
  if (needs_of(running.effects).body || needs_of(next.effects).body)
    return "the scene's dynamic object is a body that lies somewhere by itself, and a scene built anew would not know where: "
           "restart the ring for it";
  return {};
}

std::vector<EffectSpec> carried_over(std::span<const EffectSpec> before, std::span<const EffectSpec> now,
                                     std::span<const EffectSpec> next) {
  std::vector<EffectSpec> effects(next.begin(), next.end());
  for (EffectSpec& effect : effects) {
    const auto old = std::find_if(before.begin(), before.end(), [&](const EffectSpec& e) { return same(e, effect); });
    if (old != before.end()) effect = now[static_cast<std::size_t>(old - before.begin())];
  }
  return effects;
}

}  // namespace voxtouch
