#pragma once
/// Simulated devices on a command line, described by a file: `sim:FILE`, or `sim:NAME` for a
/// shipped file.
#include <optional>
#include <string>
#include <vector>

#include "core/scene/device_file.hpp"

namespace voxtouch::device_node {

/// Names of the shipped device files, sorted; empty if their folder is missing.
std::vector<std::string> shipped_devices();

/// Reads the file of `sim:...`; returns nothing for other devices. Throws scene::SceneError for an
/// invalid file, and std::runtime_error, with the shipped names, for a missing one.
std::optional<scene::DeviceFile> described_device(const std::string& device);

/// Only its description, for devices::DeviceOptions.
std::optional<DeviceDescription> description_of(const std::string& device);

/// Throws devices::DeviceOpenError if `file` describes another device than `driver`
/// (scene::other_device).
void require_same_device(const std::filesystem::path& path, const scene::DeviceFile& file,
                         const DeviceDescription& driver, std::string_view serial);

}  // namespace voxtouch::device_node
