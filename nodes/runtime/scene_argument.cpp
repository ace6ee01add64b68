#include "nodes/runtime/scene_argument.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "core/types/program_folder.hpp"

namespace voxtouch::runtime {
namespace {

constexpr std::size_t kNameShown = 64;  ///< of a name that is none, in the message

std::filesystem::path scene_folder() { return shared_folder() / "scenes"; }

std::string find_scene(std::string& text) {
  std::error_code error;
  const auto status = std::filesystem::status(text, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_directory(status)) return {};
  const std::vector<std::string> names = shipped_scenes();
  if (!std::ranges::binary_search(names, text))
    return fmt::format("'{}' is no file, and no scene of this name comes with voxtouch. These do: {}", text.substr(0, kNameShown),
                       fmt::join(names, ", "));
  text = std::filesystem::canonical(scene_folder() / (text + ".yaml")).string();
  return {};
}

}  // namespace

std::vector<std::string> shipped_scenes() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(scene_folder(), error))
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  std::ranges::sort(names);
  return names;
}

CLI::Validator scene_argument() { return {find_scene, "FILE|NAME", "scene"}; }

}  // namespace voxtouch::runtime
