#pragma once
/// The network between this controller and its remote side.
#include "devices/arm/simulated/line.hpp"
#include "devices/lwr/fri_packets.hpp"
#include "devices/lwr/simulated/faults.hpp"

namespace voxtouch::lwr_sim {

using Line = arm_sim::Line<lwr::fri::MsrPacket, FaultSchedule, kFaultKinds>;

}  // namespace voxtouch::lwr_sim
