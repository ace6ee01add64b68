#pragma once
/// Whether a motion of the hand is within a device's workspace.
#include <string>
#include <string_view>

#include "core/types/motion.hpp"

namespace voxtouch::scene {

/// A sentence if `motion`, of the device's tip in D, spans more than the device's workspace along
/// an axis, with the scale that would fit. Empty if it fits for some position of the device.
/// `workspace_m`: edges of the box along the axes of D. Allocates.
std::string beyond_workspace(const Motion& motion, const Vec3& workspace_m,
                             std::string_view device);

}  // namespace voxtouch::scene
