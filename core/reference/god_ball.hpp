#pragma once
/// The truth for a virtual tool that is a ball: the exact ball that stays outside the exact surface
/// and is drawn to the hand.
#include "core/reference/reference_scene.hpp"

namespace voxtouch::reference {

/// Centre of a ball of `radius_m` that goes from `centre`, where it must be outside (a touch is),
/// towards `hand`, keeping outside of the static surface: it goes on in short steps, and out of the
/// nearest face again, until it comes no nearer (Zilles and Salisbury 1995). Not of moving objects.
/// Allocates.
Vec3 drawn_ball(const ReferenceScene& reference, double radius_m, const Vec3& centre,
                const Vec3& hand);

}  // namespace voxtouch::reference
