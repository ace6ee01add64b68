#pragma once
/// Bodies and drives of the FR3, for the mechanics common to all arms.
#include "devices/arm/simulated/arm_plant.hpp"
#include "devices/fr3/fr3_arm.hpp"

namespace voxtouch::fr3_sim {

/// Links: masses, centres and inertias of the manufacturer's robot description of the FR3
/// (confirmed). Rotors: reflected inertia given by the manufacturer for the FR3, as quoted by a
/// published model, divided by `torque_feedback_gain`, the reduction by a torque loop; 4 is
/// assumed.
arm_sim::ArmBodies fr3_bodies(double torque_feedback_gain = 4.0);

/// With limits of the FR3's data sheet (confirmed). Residual friction, and brakes of twice the
/// drives' torque, are assumed. The tool T is given in the flange.
arm_sim::PlantParameters fr3_plant(const Pose& pose_FT = {}, double torque_feedback_gain = 4.0);

/// Speed limits of the FR3's joints [rad/s] (confirmed).
arm::Joints fr3_speed_limit() noexcept;

}  // namespace voxtouch::fr3_sim
