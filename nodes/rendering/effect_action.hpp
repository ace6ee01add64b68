#pragma once
/// Maps the action of an EffectChange message to an effect action.
#include "core/effects/effect_change.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::rendering_node {

/// For actions on an effect; ACTION_RELOAD does not name one.
inline effects::EffectAction effect_action(std::uint32_t action) noexcept {
  return action == msg::effect_change::kActionSwitch ? effects::EffectAction::kSwitch
         : action == msg::effect_change::kActionGain ? effects::EffectAction::kGain
                                                     : effects::EffectAction::kValue;
}

}  // namespace voxtouch::rendering_node
