#pragma once
/// What can be known before any node starts is said before any node starts.
#include <filesystem>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "devices/device_options.hpp"

namespace voxtouch::cli {

struct Plans {
  std::string device;
  devices::DeviceSettings settings;
  std::string motion;
  std::filesystem::path device_file;  ///< empty: none
  std::filesystem::path bag;          ///< empty: none
  double network_delay_ms = 0.0;
  bool lockstep = false;
  bool hand_from_page = false;
};

/// Throws std::runtime_error, a sentence: unknown device, device option or motion, a device that
/// the coupling node would command no force for whatever the scene is built to, a bag folder that
/// exists or could not be made. Returns what a user may want to know, as sentences.
std::vector<std::string> check_before_start(const scene::Scene& scene, const Plans& plans);

/// The sentence for a scene and a device of which rendering or coupling said `why` no force may be
/// commanded.
std::string does_not_go_with(const std::filesystem::path& scene, const std::string& device,
                             const std::string& why);

}  // namespace voxtouch::cli
