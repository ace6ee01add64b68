#pragma once
/// Devices by the names that people type.
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "devices/device_options.hpp"
#include "devices/driver.hpp"

namespace voxtouch::devices {

/// "sim-phantom", "sim-lwr": arithmetic alone; so is "sim:FILE", any device as a file describes it,
/// which is not among the names. "emulated-phantom", "emulated-lwr", "emulated-fr3": the drivers of
/// the hardware, with the vendor's library or the controller's side of the network simulated.
/// "phantom", "lwr", "fr3": the hardware.
const std::vector<std::string>& device_names();

/// Opens a device. Throws DeviceOpenError with the remedy: an unknown name, an unknown option or
/// value, a motion or hand that cannot be simulated, or missing hardware.
std::unique_ptr<Driver> open_device(std::string_view name, const DeviceOptions& options = {});

/// The device's properties, as known without opening it; hardware may report others when opened.
/// Throws as open_device does for names and settings.
DeviceDescription describe_device(std::string_view name, const DeviceOptions& options = {});

/// Prefix of a device that a file describes.
inline constexpr std::string_view kDescribedPrefix = "sim:";

/// Whether a simulated hand grips the device and follows options.motion; else a person does.
bool has_simulated_hand(std::string_view name);

/// DeviceOptions::is_led may be set: the device is arithmetic alone.
bool can_be_led(std::string_view name);
/// Throws DeviceOpenError if its hand cannot be led.
void require_led(std::string_view name);

/// How a simulated hand usually holds the device: a start for options.hand. Throws DeviceOpenError
/// for an unknown name and for hardware.
sim::OperatorConfig usual_hand(std::string_view name, const DeviceOptions& options = {});

}  // namespace voxtouch::devices
