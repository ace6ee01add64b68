#pragma once
/// Devices by the names that people type.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/types/motion.hpp"
#include "devices/driver.hpp"
#include "devices/sim/operator.hpp"

namespace voxtouch {

/// What opening a device may need; real devices use none of it.
struct DeviceOptions {
  std::uint64_t seed = 0;              ///< of a simulated hand's tremor
  std::optional<Motion> motion;        ///< where a simulated hand goes, in D; absent: it stays at the origin
  std::optional<OperatorConfig> hand;  ///< absent: the usual grip, usual_hand(name)
};

/// Names that open_device knows, those that it refuses among them.
const std::vector<std::string>& device_names();

/// Opens a device. Throws DeviceOpenError: an unknown name (the sentence lists the known ones), a device that
/// this version has no driver for (it says what to use instead), or options that cannot be simulated.
std::unique_ptr<Driver> open_device(std::string_view name, const DeviceOptions& options = {});

/// The device's numbers, without opening it. Throws like open_device.
DeviceDescription describe_device(std::string_view name);

/// How a simulated device is usually held: a start for options.hand. Throws like open_device.
OperatorConfig usual_hand(std::string_view name);

}  // namespace voxtouch
