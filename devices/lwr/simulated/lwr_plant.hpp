#pragma once
/// Bodies and drives of the light-weight robot, for the mechanics common to all arms.
#include "devices/arm/simulated/arm_plant.hpp"
#include "devices/arm/simulated/control_laws.hpp"
#include "devices/lwr/lwr_arm.hpp"

namespace voxtouch::lwr_sim {

using arm_sim::ArmBodies;
using arm_sim::ArmDynamics;
using arm_sim::ArmPlant;
using arm_sim::Drives;
using arm_sim::Impedance;
using arm_sim::in_axes;
using arm_sim::kGravity;
using arm_sim::LawParameters;
using LwrMatrix = arm_sim::JointMatrix;
using arm_sim::Link;
using arm_sim::PlantParameters;
using arm_sim::position_law;
using arm_sim::Setpoint;
using arm_sim::task_axes;
using arm_sim::TipLoad;
using arm_sim::tool_wrench;

/// Links: the physically consistent set of published robot descriptions (confirmed). Rotors:
/// reflected motor inertia (unconfirmed), divided by `torque_feedback_gain`. A torque loop that
/// feeds back k times the torque error makes the motor appear (1 + k) times lighter; 4 is assumed.
ArmBodies lwr_bodies(double torque_feedback_gain = 4.0);

/// Published drive friction, divided by the gain of the torque feedback, which reduces it like the
/// rotors (assumed); brakes of twice the drives' torque (assumed); published limits.
PlantParameters lwr_plant(double torque_feedback_gain = 4.0);

}  // namespace voxtouch::lwr_sim
