#pragma once
/// What an EffectChange asks of an effect.
#include "core/effects/effect_change.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::rendering_node {

/// Of the actions on an effect; ACTION_RELOAD is none.
inline effects::EffectAction effect_action(std::uint32_t action) noexcept {
  return action == msg::effect_change::kActionSwitch ? effects::EffectAction::kSwitch
         : action == msg::effect_change::kActionGain ? effects::EffectAction::kGain
                                                     : effects::EffectAction::kValue;
}

}  // namespace voxtouch::rendering_node
