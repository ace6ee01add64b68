#pragma once
/// Where the arm stands before anything happens.
#include "devices/lwr/lwr_arm.hpp"

namespace voxtouch::lwr_sim {

/// Joint angles near `posture` that bring the tool to `wanted` (base), found by damped least squares. Throws std::runtime_error
/// with a sentence where the arm cannot reach it within its joints' limits.
lwr::LwrJoints start_posture(const lwr::LwrArm& arm, const Pose& wanted, const lwr::LwrJoints& posture);

}  // namespace voxtouch::lwr_sim
