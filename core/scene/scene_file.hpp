#pragma once
/// Reads a scene file strictly. Whatever is unknown, missing, doubled, of the wrong type, not
/// finite or out of its range is a SceneError that says where and what would be right; nothing is
/// guessed and nothing is skipped.
///
/// The keys stand in keys.hpp, and for people in deploy/scenes/README.md. `cutoff_hz` is w0 / (2
/// pi): the -3 dB frequency only for damping_ratio = 1/sqrt(2).
#include <filesystem>
#include <string>

#include "core/scene/scene.hpp"
#include "core/scene/scene_error.hpp"

namespace voxtouch::scene {

/// Period that a scene's coupling is judged for; check_device judges it again for the device's own.
inline constexpr double kSceneSampleTimeS = 1e-3;

/// Reads `file`. Throws SceneError. Relative mesh paths start at the scene file's folder.
Scene load_scene(const std::filesystem::path& file);

/// The same for text that stands in memory; `file` names it and says where its meshes are.
Scene parse_scene(const std::string& text, const std::filesystem::path& file);

}  // namespace voxtouch::scene
