#pragma once
/// 'fr3': driver of the Franka arm on the network. 'emulated-fr3': the same driver with the
/// simulated robot.
#include <memory>

#include "devices/device_options.hpp"
#include "devices/driver.hpp"
#include "devices/fr3/fr3_options.hpp"

namespace voxtouch::fr3 {

/// Opens the arm. Throws DeviceOpenError. The axes of D are those of the base; T is parallel to
/// them in the rest posture. Settings:
///   address: of the robot (172.16.0.2); port (1337)
///   connect_timeout_s (3)
///   rest: position of the tool in D in the rest posture, X,Y,Z [m]
///   tool: origin of the tool in the flange's frame, X,Y,Z [m]
///   load_kg, load_centre: load in addition to that of the robot's web page, centre in the flange
///   X,Y,Z [m]
std::unique_ptr<devices::Driver> open_fr3(const devices::DeviceOptions& options);
/// Without opening.
DeviceDescription describe_fr3_device(const devices::DeviceOptions& options);

/// Starts voxtouch_fci_robot, from the folder of the running program, on loopback and a free port;
/// it ends with the driver. Throws DeviceOpenError. The hand moves in D. In lockstep time is
/// virtual: equal options give bit-identical results. Settings:
///   rest, tool: as above
///   server_version: of the robot (10)
///   fault: KIND@START[:DURATION[:VALUE]] as in devices/arm/simulated/faults.hpp, any number of
///   times
std::unique_ptr<devices::Driver> open_emulated_fr3(const devices::DeviceOptions& options);
DeviceDescription describe_emulated_fr3(const devices::DeviceOptions& options);

/// Sets D and T so that the tool in the rest posture is at `rest_in_d`, with the axes of T, D and
/// the base parallel.
void place(Fr3Options& options, const Vec3& rest_in_d, const Vec3& tool_F);

}  // namespace voxtouch::fr3
