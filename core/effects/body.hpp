#pragma once
/// Values of the effect `body` in the form of its motion.
#include "core/effects/effect_kind.hpp"
#include "core/effects/rigid_body.hpp"

namespace voxtouch::effects {

/// Mass, gravity and grip of a body with these values, in SI units. Real-time safe.
BodyParameters body_parameters(const EffectValues& values) noexcept;
/// -1: always gripped.
int grab_button(const EffectValues& values) noexcept;
/// Largest distance from the tool at which the body can be gripped [m]. Real-time safe.
double grab_distance_m(const EffectValues& values) noexcept;

}  // namespace voxtouch::effects
