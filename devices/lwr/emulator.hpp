#pragma once
/// 'lwr': the light-weight robot's driver on the network. 'emulated-lwr': the same driver at the
/// simulated controller.
#include <memory>

#include "devices/device_options.hpp"
#include "devices/driver.hpp"
#include "devices/lwr/lwr_options.hpp"

namespace voxtouch::lwr {

/// Settings: address, port (of this machine, as in friSetup), controller (the only address to
/// listen to), connect_timeout_s (3), rest (where the tool lies in D while the arm stands in its
/// rest posture, X,Y,Z [m]), tool (the tool's origin in the flange's frame, X,Y,Z [m]), capture
/// (pcap file of the last packets). Axes of D are the base's; T is parallel to them in the rest
/// posture. Throws DeviceOpenError.
std::unique_ptr<devices::Driver> open_lwr(const devices::DeviceOptions& options);
/// Without opening. The rate is the usual one: the controller decides it.
DeviceDescription describe_lwr_device(const devices::DeviceOptions& options);

/// Starts voxtouch_fri_controller, which stands next to the running program, on the loopback and a
/// free port; it ends with the driver. Settings: period_ms (1), rest, tool, capture as above, trace
/// (CSV of the controller's every period), and, any number of times, fault:
/// KIND@START[:DURATION[:VALUE]] as in devices/arm/simulated/faults.hpp. The hand moves in D. In
/// lockstep time is virtual: the same options give bit-identical results. Throws DeviceOpenError.
std::unique_ptr<devices::Driver> open_emulated_lwr(const devices::DeviceOptions& options);
DeviceDescription describe_emulated_lwr(const devices::DeviceOptions& options);

/// D and T so that the tool at the rest posture lies at `rest_in_d`, with the axes of T, D and the
/// base parallel.
void place(LwrOptions& options, const Vec3& rest_in_d, const Vec3& tool_F);

}  // namespace voxtouch::lwr
