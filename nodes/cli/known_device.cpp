#include "nodes/cli/known_device.hpp"

#include "core/scene/device_file.hpp"
#include "devices/registry.hpp"
#include "nodes/console/log.hpp"
#include "nodes/device/described_device.hpp"

namespace voxtouch::cli {
namespace {

bool is_file(const std::string& device) {
  return !device.starts_with(devices::kDescribedPrefix) &&
         (device.ends_with(".yaml") || device.ends_with(".yml"));
}

}  // namespace

std::string device_argument(const std::string& device) {
  return is_file(device) ? std::string(devices::kDescribedPrefix) + device : device;
}

coupling::design::DeviceModel find_device(const std::string& device) {
  const auto file = device_node::described_device(device_argument(device));
  if (!file)
    return coupling::design::model_of(devices::describe_device(device));
  if (const std::string assumed = scene::assumed_sentence(*file); !assumed.empty())
    console::log("note: {}\n", assumed);
  return coupling::design::model_of(file->description);
}

}  // namespace voxtouch::cli
