#pragma once
/// One effect as specified by a scene, and the resources and bounds of a list of effects.
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/effects/effect_kind.hpp"
#include "core/effects/region.hpp"

namespace voxtouch::effects {

/// One effect as specified by a scene.
struct EffectSpec {
  /// Name for run-time changes: that of the kind, with a number from the second on.
  std::string name;
  const EffectKind* kind = nullptr;
  EffectValues values;
  Region region;
  std::optional<std::uint32_t> object =
      {};             ///< responds to the contact with this static object only; 0: the static scene
  double gain = 1.0;  ///< 0..1
  bool on = true;     ///< off: built and ready, gain 0
  /// Position in the file, `file:line:column`, for messages; may be empty.
  std::string place = {};
  std::string text = {};  ///< of its kind's kText parameter; empty if omitted
};

/// Union of their resources: the largest `proximity_m` and `smoothing_m`, the smallest `lever_m`.
EffectNeeds needs_of(std::span<const EffectSpec> effects);
/// The effect that follows a program outside the ring; null without one. A scene has at most one.
const EffectSpec* external_of(std::span<const EffectSpec> effects);
/// States that no certificate covers such an effect, and which bounds hold instead.
std::string no_certificate_sentence(std::string_view name);
/// Bound of one effect with its region, at full gain. A region adds 2 |grad w| F + |grad^2 w| U to
/// the stiffness of a conservative kind and |grad w| F to that of any other. The result is infinite
/// if F or U is unbounded.
EffectBound bound_of(const EffectSpec& effect);

}  // namespace voxtouch::effects
