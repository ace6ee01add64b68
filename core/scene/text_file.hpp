#pragma once
/// Reads the small text files that people write: scenes and device files.
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/scene/scene_error.hpp"

namespace voxtouch::scene {

/// Largest file of this kind [bytes]; large data (meshes) is in separate files.
inline constexpr std::uintmax_t kLargestTextFile = std::uintmax_t{1} << 20;

/// The bytes of `file`. `what` ("scene", "device") names it in messages. Throws SceneError if it
/// does not exist or is unreadable.
std::string read_text_file(const std::filesystem::path& file, std::string_view what);

}  // namespace voxtouch::scene
