#include "devices/driver.hpp"

namespace voxtouch::devices {

std::string_view name_of(DeviceError error) noexcept {
  switch (error) {
    case DeviceError::kTimeout: return "timeout";
    case DeviceError::kDisconnected: return "disconnected";
    case DeviceError::kNotFinite: return "not_finite";
    case DeviceError::kLimit: return "limit";
    case DeviceError::kProtocol: return "protocol";
    case DeviceError::kRecoverable: return "recoverable";
    case DeviceError::kFault: return "fault";
  }
  return "unknown";
}

}  // namespace voxtouch::devices
