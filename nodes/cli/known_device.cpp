#include "nodes/cli/known_device.hpp"

#include "devices/registry.hpp"

namespace voxtouch::cli {

DeviceModel find_device(const std::string& device) {
  if (device.ends_with(".yaml") || device.ends_with(".yml")) return load_device_file(device);
  return model_of(describe_device(device));
}

}  // namespace voxtouch::cli
