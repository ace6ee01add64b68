#include "nodes/cli/known_device.hpp"

#include "devices/registry.hpp"
#include "nodes/runtime/device_model.hpp"

namespace voxtouch::cli {

DeviceFile find_device(const std::string& device) {
  if (device.ends_with(".yaml") || device.ends_with(".yml")) return load_device_file(device);
  const DeviceDescription description = describe_device(device);
  DeviceFile out;
  out.model = runtime::model_of(description, device.starts_with("sim-"));
  parse_grip(description.grip, out.grip);
  return out;
}

}  // namespace voxtouch::cli
