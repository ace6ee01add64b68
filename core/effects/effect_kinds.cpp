// The list of all effects. Everything else about an effect is in its own file.
#include <algorithm>
#include <array>

#include "core/effects/effect.hpp"

namespace voxtouch::effects {

extern const EffectKind kBody;
extern const EffectKind kExternal;
extern const EffectKind kFriction;
extern const EffectKind kGuideLine, kGuidePlane, kGuidePoint;
extern const EffectKind kMagnet;
extern const EffectKind kProximity;
extern const EffectKind kSurfaceDamping;
extern const EffectKind kTexture;
extern const EffectKind kViscosity;

namespace {

constexpr std::array kKinds = {&kBody,           &kExternal,   &kFriction, &kGuideLine,
                               &kGuidePlane,     &kGuidePoint, &kMagnet,   &kProximity,
                               &kSurfaceDamping, &kTexture,    &kViscosity};

}  // namespace

std::span<const EffectKind* const> effect_kinds() noexcept { return kKinds; }

const EffectKind* find_effect_kind(std::string_view name) noexcept {
  const auto found = std::find_if(kKinds.begin(), kKinds.end(),
                                  [&](const EffectKind* kind) { return kind->name == name; });
  return found == kKinds.end() ? nullptr : *found;
}

}  // namespace voxtouch::effects
