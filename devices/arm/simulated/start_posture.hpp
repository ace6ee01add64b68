#pragma once
/// Where the arm stands before anything happens.
#include <functional>

#include "devices/arm/joints.hpp"

namespace voxtouch::arm_sim {

/// What one posture gives: T in the base, and the Jacobian of its origin.
struct Reach {
  Pose tool;
  arm::Jacobian jacobian;
};

/// Joint angles near `posture` that bring the tool to `requested` (base), found by damped least
/// squares. Throws std::runtime_error with a sentence where the arm cannot reach it within its
/// joints' limits.
arm::Joints start_posture(const std::function<Reach(const arm::Joints&)>& arm,
                          const Pose& requested, const arm::Joints& posture,
                          const arm::Joints& lowest_rad, const arm::Joints& highest_rad);

}  // namespace voxtouch::arm_sim
