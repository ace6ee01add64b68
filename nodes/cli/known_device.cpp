#include "nodes/cli/known_device.hpp"

#include "devices/registry.hpp"

namespace voxtouch::cli {

coupling::design::DeviceModel find_device(const std::string& device) {
  if (device.ends_with(".yaml") || device.ends_with(".yml")) return scene::load_device_file(device);
  return coupling::design::model_of(devices::describe_device(device));
}

}  // namespace voxtouch::cli
