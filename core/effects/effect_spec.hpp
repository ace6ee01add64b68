#pragma once
/// One effect as a scene asks for it, and what a list of them needs and can do.
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/effects/effect_kind.hpp"
#include "core/effects/region.hpp"

namespace voxtouch::effects {

/// One effect as a scene asks for it.
struct EffectSpec {
  std::string name;  ///< of this one, for the change while running: the kind's, with a number from
                     ///< the second on
  const EffectKind* kind = nullptr;
  EffectValues values;
  Region region;
  std::optional<std::uint32_t> object =
      {};                  ///< feels the contact with this static object alone; 0: the ground
  double gain = 1.0;       ///< 0..1
  bool on = true;          ///< off: built and ready, gain 0
  std::string place = {};  ///< where it was read, `file:line:column`, for messages; may be empty
  std::string text = {};   ///< of its kind's kText parameter; empty: left out
};

/// Union of what they need: the largest `proximity_m` and `smoothing_m`, the least `lever_m`.
EffectNeeds needs_of(std::span<const EffectSpec> effects);
/// The one that follows a program outside the ring; null where there is none. A scene has one at
/// most.
const EffectSpec* external_of(std::span<const EffectSpec> effects);
/// What is reported of such an effect: that no certificate covers it, and what holds instead.
std::string no_certificate_sentence(std::string_view name);
/// Bound of one effect behind its region, at full gain. A region adds 2 |grad w| F + |grad^2 w| U
/// to the stiffness of a conservative kind and |grad w| F to that of any other: infinite where F or
/// U has no bound.
EffectBound bound_of(const EffectSpec& effect);

}  // namespace voxtouch::effects
