#include "devices/driver.hpp"

#include "core/types/enum_name.hpp"

namespace voxtouch::devices {

std::string_view name_of(DeviceError error) noexcept {
  constexpr std::array<std::string_view, 7> kNames{
      "timeout", "disconnected", "not_finite", "limit", "protocol", "recoverable", "fault"};
  return name_in(kNames, error);
}

}  // namespace voxtouch::devices
