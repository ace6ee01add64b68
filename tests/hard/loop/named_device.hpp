#pragma once
/// A simulated device by name: "sim-phantom", "sim-lwr", or a file of deploy/devices without its
/// ending.
#include <string>

#include "core/scene/device_file.hpp"
#include "devices/sim/parameters.hpp"

namespace voxtouch::long_runs {

inline sim::SimParameters named_device(const std::string& name) {
  if (name == "sim-phantom")
    return sim::sim_phantom();
  if (name == "sim-lwr")
    return sim::sim_lwr();
  return sim::simulated(
      scene::load_device_file(std::string(VOXTOUCH_DEVICES) + "/" + name + ".yaml").description);
}

}  // namespace voxtouch::long_runs
