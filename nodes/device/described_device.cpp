#include "nodes/device/described_device.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/types/shipped_files.hpp"
#include "devices/registry.hpp"

namespace voxtouch::device_node {
namespace {

constexpr std::size_t kMaxPrinted = 256;  ///< shown part of an unknown name, in messages

}  // namespace

std::vector<std::string> shipped_devices() { return shipped_files("devices"); }

std::optional<scene::DeviceFile> described_device(const std::string& device) {
  if (!device.starts_with(devices::kDescribedPrefix))
    return std::nullopt;
  const std::string name = device.substr(devices::kDescribedPrefix.size());
  std::error_code error;
  if (std::filesystem::exists(name, error))
    return scene::load_device_file(name);
  const std::vector<std::string> names = shipped_devices();
  if (!std::ranges::binary_search(names, name))
    throw std::runtime_error(
        fmt::format("'{}' is neither a file nor a shipped device file. Shipped device files: {}",
                    name.substr(0, kMaxPrinted), fmt::join(names, ", ")));
  return scene::load_device_file(shipped_file("devices", name));
}

std::optional<DeviceDescription> description_of(const std::string& device) {
  const auto file = described_device(device);
  return file ? std::optional(file->description) : std::nullopt;
}

void require_same_device(const std::filesystem::path& path, const scene::DeviceFile& file,
                         const DeviceDescription& driver, std::string_view serial) {
  if (const std::string other = scene::other_device(file, driver, serial); !other.empty())
    throw devices::DeviceOpenError(
        fmt::format("--device-file {} is not the file of this device: {}. Measure this device: "
                    "voxtouch identify --out FILE",
                    path.string(), other));
}

}  // namespace voxtouch::device_node
