#pragma once
/// 'lwr': driver of the light-weight robot on the network. 'emulated-lwr': the same driver with the
/// simulated controller.
#include <memory>

#include "devices/device_options.hpp"
#include "devices/driver.hpp"
#include "devices/lwr/lwr_options.hpp"

namespace voxtouch::lwr {

/// Opens the arm. Throws DeviceOpenError. The axes of D are those of the base; T is parallel to
/// them in the rest posture. Settings:
///   address, port: of this machine, as in friSetup
///   controller: the only address to accept
///   connect_timeout_s (3)
///   rest: position of the tool in D in the rest posture, X,Y,Z [m]
///   tool: origin of the tool in the flange's frame, X,Y,Z [m]
///   capture: pcap file of the last packets
std::unique_ptr<devices::Driver> open_lwr(const devices::DeviceOptions& options);
/// Without opening. The rate is the usual one; the controller decides it.
DeviceDescription describe_lwr_device(const devices::DeviceOptions& options);

/// Starts voxtouch_fri_controller, from the folder of the running program, on loopback and a free
/// port; it ends with the driver. Throws DeviceOpenError. The hand moves in D. In lockstep time is
/// virtual: equal options give bit-identical results. Settings:
///   period_ms (1)
///   rest, tool, capture: as above
///   trace: CSV of every period of the controller
///   fault: KIND@START[:DURATION[:VALUE]] as in devices/arm/simulated/faults.hpp, any number of
///   times
std::unique_ptr<devices::Driver> open_emulated_lwr(const devices::DeviceOptions& options);
DeviceDescription describe_emulated_lwr(const devices::DeviceOptions& options);

/// Sets D and T so that the tool in the rest posture is at `rest_in_d`, with the axes of T, D and
/// the base parallel.
void place(LwrOptions& options, const Vec3& rest_in_d, const Vec3& tool_F);

}  // namespace voxtouch::lwr
