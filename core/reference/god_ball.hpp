#pragma once
/// Reference for a spherical virtual tool: the exact ball that stays outside the exact surface and
/// is pulled to the hand.
#include "core/reference/reference_scene.hpp"

namespace voxtouch::reference {

/// Final centre of a ball of `radius_m` that moves from `centre`, which must be outside (touching
/// is allowed), towards `hand`. It moves in short steps; after each, it is moved out of the nearest
/// face, until it stops approaching (Zilles and Salisbury 1995). Moving objects are not supported.
/// Allocates.
Vec3 drawn_ball(const ReferenceScene& reference, double radius_m, const Vec3& centre,
                const Vec3& hand);

}  // namespace voxtouch::reference
