#pragma once
/// What will be felt of a scene on a device, in one line: told before anything runs.
#include <string>

#include "core/felt/changes.hpp"

namespace voxtouch::felt {

/// "What will be felt: 371 N/m at the hand, certified with a margin of 2: 3.71 N with the hand 10
/// mm deep, 44 % of the 8.5 N that ... gives ...", with what limits it and what would give more:
/// the change that helps most, and two where less than a fifth of the device's force can be shown
/// 10 mm deep. Of a virtual tool, whose force is stiffness times depth, and of a body's grip, that
/// is known; else a hand presses (press.hpp) where the scene's motion of this name touches first,
/// which is named, or where `motion` is empty the first that touches. Empty where nothing may be
/// felt, or no motion touches. `search`: kAll; or kKnown, which where less than a fifth is shown is
/// kFirst. Not for the loop.
std::string felt_sentence(const fitting::FittedCoupling& fitted, const scene::Scene& scene,
                          const coupling::design::DeviceModel& device, rendering::BuiltScene& built,
                          const std::string& motion = "", Search search = Search::kAll);

/// What limits a coupling that shows `at_hand_n_per_m` and gives `force_n` at the depth told: a
/// sentence or more. Empty: nothing is known.
std::string limit_of(const fitting::FittedCoupling& fitted,
                     const coupling::design::DeviceModel& device, double at_hand_n_per_m,
                     double force_n);

}  // namespace voxtouch::felt
