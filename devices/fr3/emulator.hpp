#pragma once
/// 'fr3': the Franka arm's driver on the network. 'emulated-fr3': the same driver at the simulated
/// robot.
#include <memory>

#include "devices/device_options.hpp"
#include "devices/driver.hpp"
#include "devices/fr3/fr3_options.hpp"

namespace voxtouch::fr3 {

/// Settings: address (of the robot, 172.16.0.2), port (1337), connect_timeout_s (3), rest (where
/// the tool lies in D while the arm stands in its rest posture, X,Y,Z [m]), tool (the tool's origin
/// in the flange's frame, X,Y,Z [m]), load_kg and load_centre (what the flange carries in addition
/// to what the robot's web page lists, centre in the flange X,Y,Z [m]). Axes of D are the base's; T
/// is parallel to them in the rest posture. Throws DeviceOpenError.
std::unique_ptr<devices::Driver> open_fr3(const devices::DeviceOptions& options);
/// Without opening.
DeviceDescription describe_fr3_device(const devices::DeviceOptions& options);

/// Starts voxtouch_fci_robot, which stands next to the running program, on the loopback and a free
/// port; it ends with the driver. Settings: rest, tool as above, server_version (10) of the robot,
/// and, any number of times, fault: KIND@START[:DURATION[:VALUE]] as in
/// devices/arm/simulated/faults.hpp. The hand moves in D. In lockstep time is virtual: the same
/// options give bit-identical results. Throws DeviceOpenError.
std::unique_ptr<devices::Driver> open_emulated_fr3(const devices::DeviceOptions& options);
DeviceDescription describe_emulated_fr3(const devices::DeviceOptions& options);

/// D and T so that the tool at the rest posture lies at `rest_in_d`, with the axes of T, D and the
/// base parallel.
void place(Fr3Options& options, const Vec3& rest_in_d, const Vec3& tool_F);

}  // namespace voxtouch::fr3
