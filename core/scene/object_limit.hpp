#pragma once
/// How many static objects a scene may have: what effects keep for each of them is of fixed size.
#include <cstddef>

namespace voxtouch::scene {

inline constexpr std::size_t kMaxObjects = 16;  ///< the ground among them

}  // namespace voxtouch::scene
