#pragma once
/// Values of the effect `body` as its motion needs them.
#include "core/effects/effect_kind.hpp"
#include "core/effects/rigid_body.hpp"

namespace voxtouch::effects {

BodyParameters body_parameters(const EffectValues& values) noexcept;
/// -1: always held.
int grab_button(const EffectValues& values) noexcept;
double grab_distance_m(const EffectValues& values) noexcept;

}  // namespace voxtouch::effects
