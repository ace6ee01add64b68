#pragma once
/// Checks that are possible before any node starts.
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

/// Throws std::runtime_error: unknown device, device option or motion, a device for which the
/// coupling node would command no force in any scene, a bag folder that exists or cannot be
/// created. Returns sentences to print.
std::vector<std::string> check_before_start(const scene::Scene& scene, const Plans& plans);

/// The sentence for a scene and a device for which rendering or coupling refused any force because
/// of `why`.
std::string does_not_go_with(const std::filesystem::path& scene, const std::string& device,
                             const std::string& why);

}  // namespace voxtouch::cli
