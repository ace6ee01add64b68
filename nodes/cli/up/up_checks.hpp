#pragma once
/// What can be known before any node starts is said before any node starts.
#include <filesystem>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "devices/device_options.hpp"
#include "nodes/cli/up/summary.hpp"
#include "nodes/scene_build/cache_options.hpp"

namespace voxtouch::cli {

struct Plans {
  std::string device;
  devices::DeviceSettings settings;
  std::string motion;
  std::filesystem::path bag;  ///< empty: none
  double network_delay_ms = 0.0;
  bool lockstep = false;
  scene_build::CacheOptions cache = {};
};

/// Throws std::runtime_error, a sentence: unknown device, device option or motion, a scene that
/// cannot be built, a device that the coupling node would command no force for with this scene, a
/// bag folder that exists or could not be made. Returns what a user may want to know, as sentences;
/// warnings of the scene as it is built go to `warnings`. Takes as long as the scene is built for.
std::vector<std::string> check_before_start(const scene::Scene& scene, const Plans& plans,
                                            std::vector<std::string>& warnings);

/// Sorts what the nodes have reported into problems and notes.
void judge(RunSummary& summary);

}  // namespace voxtouch::cli
