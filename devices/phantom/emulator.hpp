#pragma once
/// 'phantom': the Phantom's driver with the vendor's library. 'emulated-phantom': the same driver
/// with the simulated library.
#include <memory>

#include "devices/device_options.hpp"
#include "devices/driver.hpp"

namespace voxtouch::phantom {

/// Settings: library (file of the vendor's library), name (of the device), rate_hz, max_force_n,
/// max_speed_m_per_s, encoder_reset (if_needed or always), calibration_timeout_s, rest (where the
/// origin of the library's frame lies in D, X,Y,Z [m]). Throws DeviceOpenError.
std::unique_ptr<devices::Driver> open_phantom(const devices::DeviceOptions& options);
/// Without opening: what is known of a Phantom of any model.
DeviceDescription describe_phantom_device(const devices::DeviceOptions& options);

/// Settings: library (file of the simulated library; else ../lib/voxtouch/libHD_sim.so from the
/// running program), model (premium, premium-6dof, desktop, omni), rate_hz, max_force_n, rest as
/// above, and, any number of times, fault: KIND@SECONDS[:AMOUNT] of the device's time, kinds and
/// amounts as in hdsim.h: comm_error device_fault (ticks; for good unless given), timer_error,
/// warm_motors (1.5), late_tick (0.05 s), skipped_ticks (50), nan_position (20 ticks). The hand
/// moves in D. In lockstep time is virtual: the same options give bit-identical results. One a
/// process. Throws DeviceOpenError.
std::unique_ptr<devices::Driver> open_emulated_phantom(const devices::DeviceOptions& options);
DeviceDescription describe_emulated_phantom(const devices::DeviceOptions& options);

}  // namespace voxtouch::phantom
