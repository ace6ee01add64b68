#include "core/scene/scene_error.hpp"

#include <fmt/core.h>

namespace voxtouch::scene {

std::string at_place(const std::filesystem::path& file, SourcePlace place,
                     const std::string& sentence) {
  if (place.line == 0)
    return fmt::format("{}: {}", file.string(), sentence);
  return fmt::format("{}:{}:{}: {}", file.string(), place.line, place.column, sentence);
}

SceneError::SceneError(const std::filesystem::path& file, SourcePlace place,
                       const std::string& sentence)
    : std::runtime_error(at_place(file, place, sentence)),
      place_(place),
      sentence_(sentence) {}

}  // namespace voxtouch::scene
