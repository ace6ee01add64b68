#pragma once
/// Values of the effect `body` as its motion needs them.
#include "core/effects/effect_kind.hpp"
#include "core/effects/rigid_body.hpp"

namespace voxtouch::effects {

/// Mass, gravity and grip of a body with these values, in SI units. Real-time safe.
BodyParameters body_parameters(const EffectValues& values) noexcept;
/// -1: always held.
int grab_button(const EffectValues& values) noexcept;
/// How near the tool has to be to take the body up [m]. Real-time safe.
double grab_distance_m(const EffectValues& values) noexcept;

}  // namespace voxtouch::effects
