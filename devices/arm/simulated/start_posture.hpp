#pragma once
/// The start posture of the arm.
#include <functional>

#include "devices/arm/joints.hpp"

namespace voxtouch::arm_sim {

/// Results for one posture: T in the base, and the Jacobian of its origin.
struct Reach {
  Pose tool;
  arm::Jacobian jacobian;
};

/// Joint angles near `posture` that move the tool to `requested` (base), by damped least squares.
/// Throws std::runtime_error with a sentence if the arm cannot reach it within its joint limits.
arm::Joints start_posture(const std::function<Reach(const arm::Joints&)>& arm,
                          const Pose& requested, const arm::Joints& posture,
                          const arm::Joints& lowest_rad, const arm::Joints& highest_rad);

}  // namespace voxtouch::arm_sim
