#pragma once
/// Checks of kernel, limits, processors and devices: what impairs a ring.
#include <filesystem>
#include <vector>

#include "nodes/cli/doctor/doctor_checks.hpp"

namespace voxtouch::cli {

/// A real-time kernel, or what to install. `root`: root of the file system to read.
Finding check_kernel(const std::filesystem::path& root = "/");

/// Limits of this user: rtprio and memlock, as numbers.
Finding check_limits();

/// Processors that change their clock, and the command that holds it.
Finding check_governors(const std::filesystem::path& root = "/");

/// Whether a card is wireless or slow: for rings over several hosts. Empty for a card that is
/// neither, or unknown.
std::vector<Finding> check_link(std::string_view card, const std::filesystem::path& root = "/");

/// Haptic devices on USB, whether this user may open them, and the vendor's library.
std::vector<Finding> check_devices(const std::filesystem::path& root = "/");

}  // namespace voxtouch::cli
