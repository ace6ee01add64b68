#pragma once
/// Devices on a command line that a file describes: `sim:FILE`, or `sim:NAME` for a file that comes
/// with voxtouch.
#include <optional>
#include <string>
#include <vector>

#include "core/scene/device_file.hpp"

namespace voxtouch::device_node {

/// Names of the device files that come with voxtouch, sorted; empty where their folder is missing.
std::vector<std::string> shipped_devices();

/// The file behind `sim:...`, read; nothing for a device by name. Throws scene::SceneError for a
/// file that will not do, and std::runtime_error, which lists the shipped names, for one that is
/// not there.
std::optional<scene::DeviceFile> described_device(const std::string& device);

/// Its description alone, for devices::DeviceOptions.
std::optional<DeviceDescription> description_of(const std::string& device);

/// Throws devices::DeviceOpenError, a sentence, where `file` is another device's than the one that
/// `driver` describes (scene::other_device).
void require_same_device(const std::filesystem::path& path, const scene::DeviceFile& file,
                         const DeviceDescription& driver, std::string_view serial);

}  // namespace voxtouch::device_node
