#pragma once
/// What will be felt of a scene on a device, in one line: told before anything runs.
#include <string>
#include <vector>

#include "core/felt/press.hpp"

namespace voxtouch::felt {

/// "What will be felt: 384 N/m at the hand, certified with a margin of 2: 3.84 N with the hand 10 mm deep, 45 % of the 8.5 N that ...
/// gives ...", with what limits it and what would give more; two changes where less than a fifth of the device's force can be shown 10 mm
/// deep. Of a virtual tool, whose force is stiffness times depth, and of a body's grip, that is known; else a hand presses where `motion` touches first (press.hpp).
/// Empty where nothing may be felt, or the motion touches nothing. Not for the loop.
std::string felt_sentence(const fitting::FittedCoupling& fitted, const scene::Scene& scene, const coupling::design::DeviceModel& device,
                          rendering::BuiltScene& built, const Motion& motion);
/// The same for the first of the scene's motions that touches; without a motion, of a virtual tool or a body only.
std::string felt_sentence(const fitting::FittedCoupling& fitted, const scene::Scene& scene, const coupling::design::DeviceModel& device,
                          rendering::BuiltScene& built);

/// Of a virtual tool, whatever it touches. `bounds` as they were fitted to.
std::string felt_of_spring(const fitting::FittedCoupling& fitted, const scene::Scene& scene, const coupling::design::DeviceModel& device,
                           const rendering::StiffnessBounds& bounds);
/// Of a dynamic object that moves by itself: the spring between hand and body, `grip_n_per_m` in W as the plan tells it.
std::string felt_of_grip(const fitting::FittedCoupling& fitted, const scene::Scene& scene, const coupling::design::DeviceModel& device,
                         double grip_n_per_m);
/// Of forces that contact gives at the hand's pose. `pressed` as `press` returns it.
std::string felt_of_penalty(const fitting::FittedCoupling& fitted, const coupling::design::DeviceModel& device,
                            const std::vector<Pressed>& pressed);

}  // namespace voxtouch::felt
