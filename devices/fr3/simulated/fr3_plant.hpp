#pragma once
/// The FR3's bodies and drives, for the mechanics that all arms share.
#include "devices/arm/simulated/arm_plant.hpp"
#include "devices/fr3/fr3_arm.hpp"

namespace voxtouch::fr3_sim {

/// Links: masses, centres and inertias of the maker's own robot description of the FR3 (confirmed).
/// Rotors: reflected inertia that the maker gave for the FR3, as a published model quotes it,
/// divided by `torque_feedback_gain`, which a torque loop hides them by; 4 is assumed.
arm_sim::ArmBodies fr3_bodies(double torque_feedback_gain = 4.0);

/// With limits of the FR3's data sheet (confirmed); friction that is left, and brakes of twice the
/// drives' torque, are assumed. The tool T is given in the flange.
arm_sim::PlantParameters fr3_plant(const Pose& pose_FT = {}, double torque_feedback_gain = 4.0);

/// How fast the FR3's joints may be [rad/s] (confirmed).
arm::Joints fr3_speed_limit() noexcept;

}  // namespace voxtouch::fr3_sim
