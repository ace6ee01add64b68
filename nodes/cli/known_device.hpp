#pragma once
/// A device that is known without opening it: by name, or by a file that a lab has written.
#include <string>

#include "core/scene/device_file.hpp"

namespace voxtouch::cli {

/// Throws with the known names for one that is not there, and with the place in the file for a file that will not do.
coupling::design::DeviceModel find_device(const std::string& device);

}  // namespace voxtouch::cli
