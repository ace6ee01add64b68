#pragma once
/// Largest number of static objects of a scene: effects keep data of fixed size for each.
#include <cstddef>

namespace voxtouch::scene {

inline constexpr std::size_t kMaxObjects = 16;  ///< the ground among them

}  // namespace voxtouch::scene
