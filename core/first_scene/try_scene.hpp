#pragma once
/// Whether a scene's motions begin outside and touch: rendered along the way that the hand wants,
/// without a device.
#include <string>

#include "core/rendering/build.hpp"

namespace voxtouch::first_scene {

/// A sentence for the first motion that begins in contact or never touches within a minute; empty
/// where all are well. Some tenths of a second.
std::string what_is_wrong(const scene::Scene& scene, rendering::BuiltScene& built);

}  // namespace voxtouch::first_scene
