#pragma once
/// Whether a scene's motions begin outside and touch: rendered along the path that the hand
/// requests, without a device.
#include <string>

#include "core/rendering/build.hpp"

namespace voxtouch::scene_proposal {

/// A sentence for the first motion that begins in contact or has none within a minute; empty if
/// there is none. Some tenths of a second.
std::string validate(const scene::Scene& scene, rendering::BuiltScene& built);

}  // namespace voxtouch::scene_proposal
