#pragma once
/// 'phantom': the Phantom driver with the vendor's library. 'emulated-phantom': the same driver
/// with the simulated library.
#include <memory>

#include "devices/device_options.hpp"
#include "devices/driver.hpp"

namespace voxtouch::phantom {

/// Opens a Phantom. Throws DeviceOpenError. Settings:
///   library: file of the vendor's library
///   name: of the device
///   rate_hz, max_force_n, max_speed_m_per_s
///   encoder_reset: if_needed or always
///   calibration_timeout_s
///   rest: origin of the library's frame in D, X,Y,Z [m]
std::unique_ptr<devices::Driver> open_phantom(const devices::DeviceOptions& options);
/// Without opening: the description of a Phantom of unknown model.
DeviceDescription describe_phantom_device(const devices::DeviceOptions& options);

/// Opens the emulated Phantom. One per process. Throws DeviceOpenError. The hand moves in D. In
/// lockstep time is virtual: equal options give bit-identical results. Settings:
///   library: file of the simulated library (default ../lib/voxtouch/libHD_sim.so from the running
///   program)
///   model: premium, premium-6dof, desktop, omni
///   rate_hz, max_force_n, rest: as above
///   fault: KIND@SECONDS[:AMOUNT] of the device's time, any number of times
/// Kinds and amounts are those of hdsim.h: comm_error, device_fault (ticks; permanent by default),
/// timer_error, warm_motors (1.5), late_tick (0.05 s), skipped_ticks (50), nan_position (20 ticks).
std::unique_ptr<devices::Driver> open_emulated_phantom(const devices::DeviceOptions& options);
DeviceDescription describe_emulated_phantom(const devices::DeviceOptions& options);

}  // namespace voxtouch::phantom
