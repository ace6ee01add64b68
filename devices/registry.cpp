#include "devices/registry.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "devices/sim/simulated_device.hpp"

namespace voxtouch {
namespace {

Motion stay_at_origin() {
  Motion motion;
  motion.path.push_back(Vec3::Zero());
  return motion;
}

SimParameters parameters_of(std::string_view name) {
  if (name == "sim-phantom") return sim_phantom();
  if (name == "sim-lwr") return sim_lwr();
  if (name == "phantom" || name == "lwr")
    throw DeviceOpenError(fmt::format(
        "device '{0}': this version has no driver for the hardware; use 'sim-{0}', its simulated counterpart", name));
  throw DeviceOpenError(fmt::format("device '{}' is unknown; known are {}", name, fmt::join(device_names(), ", ")));
}

}  // namespace

const std::vector<std::string>& device_names() {
  static const std::vector<std::string> names = {"sim-phantom", "sim-lwr", "phantom", "lwr"};
  return names;
}

std::unique_ptr<Driver> open_device(std::string_view name, const DeviceOptions& options) {
  const SimParameters parameters = parameters_of(name);
  try {
    return std::make_unique<SimulatedDevice>(parameters, options.hand.value_or(parameters.hand),
                                             options.motion.value_or(stay_at_origin()), options.seed);
  } catch (const std::runtime_error& error) {
    throw DeviceOpenError(fmt::format("device '{}' cannot be opened: {}", name, error.what()));
  }
}

DeviceDescription describe_device(std::string_view name) { return parameters_of(name).description; }

OperatorConfig usual_hand(std::string_view name) { return parameters_of(name).hand; }

}  // namespace voxtouch
