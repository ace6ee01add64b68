#pragma once
/// Whether a device reaches what a hand is to do with it.
#include <string>
#include <string_view>

#include "core/types/motion.hpp"

namespace voxtouch::scene {

/// A sentence where `motion`, of the device's tip in D, spans more than the device's workspace
/// along an axis, with the scale that would bring it in; empty where it fits, wherever the device
/// is put. `workspace_m`: the edges of the box along the axes of D. Allocates.
std::string beyond_workspace(const Motion& motion, const Vec3& workspace_m,
                             std::string_view device);

}  // namespace voxtouch::scene
