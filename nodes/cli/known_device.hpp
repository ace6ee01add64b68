#pragma once
/// A device that is known without opening it: by name, or by a file that a lab has written.
#include <string>

#include "core/coupling/design/loop_parts.hpp"

namespace voxtouch::cli {

/// `sim:FILE`, a file, and `sim:NAME` of a shipped file are equivalent; what the file omits is
/// reported. Throws with the known names for an unknown one, and with the place in the file for an
/// invalid file.
coupling::design::DeviceModel find_device(const std::string& device);

/// As `up --device` takes it: a file alone gets its `sim:`.
std::string device_argument(const std::string& device);

}  // namespace voxtouch::cli
