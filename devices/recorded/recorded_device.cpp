#include "devices/recorded/recorded_device.hpp"

#include "devices/limits.hpp"
#include "devices/settings.hpp"

namespace voxtouch::recorded {
namespace {

const RecordedHand& recorded_in(const devices::DeviceOptions& options) {
  if (!options.recorded)
    throw devices::DeviceOpenError("the bag of a device 'replay:BAG' has not been read");
  return *options.recorded;
}

double speed_in(const devices::DeviceOptions& options) {
  return devices::SettingReader("replay:BAG", options.settings, {"speed", "rig"})
      .number("speed", kMinSpeed, kMaxSpeed)
      .value_or(1.0);
}

}  // namespace

devices::DeviceResult<void> RecordedDevice::write(const Wrench& command) noexcept {
  return devices::check_command(command, description());
}

std::unique_ptr<devices::Driver> open_recorded(const devices::DeviceOptions& options) {
  return std::make_unique<RecordedDevice>(recorded_in(options), speed_in(options));
}

DeviceDescription describe_recorded(const devices::DeviceOptions& options) {
  speed_in(options);
  return recorded_in(options).description;
}

}  // namespace voxtouch::recorded
