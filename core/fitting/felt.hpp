#pragma once
/// What will be felt of a virtual tool on a device, in one line: told before anything runs.
#include <string>

#include "core/fitting/fit_coupling.hpp"

namespace voxtouch::fitting {

/// "305 N/m certified: 3.05 N with the hand 10 mm deep, 36 % of the 8.5 N that ... gives, all of it 27.9 mm deep; ...": with what limits it,
/// and what would give more; two changes where less than a fifth of the device's force can be shown 10 mm deep. Empty for a scene
/// without a virtual tool, and where nothing may be felt.
std::string felt_sentence(const FittedCoupling& fitted, const scene::Scene& scene, const coupling::design::DeviceModel& device,
                          const rendering::StiffnessBounds& bounds);

}  // namespace voxtouch::fitting
