#pragma once
/// Reads a scene file strictly. An unknown, missing or duplicate key, a wrong type, or a value that
/// is not finite or out of range is a SceneError with its place and the valid values.
///
/// keys.hpp lists the keys, deploy/scenes/README.md explains them. `cutoff_hz` is w0 / (2
/// pi): the -3 dB frequency only for damping_ratio = 1/sqrt(2).
#include <filesystem>
#include <string>

#include "core/scene/scene.hpp"
#include "core/scene/scene_error.hpp"

namespace voxtouch::scene {

/// Period for which the scene's coupling is validated; check_device repeats it for the device's
/// own.
inline constexpr double kSceneSampleTimeS = 1e-3;

/// Reads `file`. Throws SceneError. Relative mesh paths start at the scene file's folder.
Scene load_scene(const std::filesystem::path& file);

/// The same for text in memory; `file` names it, and its folder is that of the meshes.
Scene parse_scene(const std::string& text, const std::filesystem::path& file);

}  // namespace voxtouch::scene
