#pragma once
/// Limits of commands, checked by every driver directly before the wire, after the guard has kept
/// to them.
#include "core/types/clamp.hpp"
#include "devices/driver.hpp"

namespace voxtouch::devices {

/// The last check before the wire: may this command go to a device with this description?
inline DeviceResult<void> check_command(const Wrench& command,
                                        const DeviceDescription& device) noexcept {
  if (!command.finite())
    return std::unexpected(DeviceError::kNotFinite);
  if (length_of(command.force) > device.max_force_n)
    return std::unexpected(DeviceError::kLimit);
  if (length_of(command.torque) > device.max_torque_nm)
    return std::unexpected(DeviceError::kLimit);
  return {};
}

}  // namespace voxtouch::devices
