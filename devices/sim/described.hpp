#pragma once
/// A device that is known by its description alone, to be simulated.
#include "devices/sim/parameters.hpp"

namespace voxtouch::sim {

/// What the description does not say is assumed: the mass is the largest along x of D and the least along z, where most scenes press; a
/// device without torque turns like its class; the twist passes 50 Hz; the hand is that of `sim-phantom` or `sim-lwr`, by the grip.
SimParameters simulated(const DeviceDescription& description);

}  // namespace voxtouch::sim
