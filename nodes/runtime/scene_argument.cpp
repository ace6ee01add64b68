#include "nodes/runtime/scene_argument.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "core/types/shipped_files.hpp"

namespace voxtouch::runtime {
namespace {

constexpr std::size_t kMaxPrintedName = 64;  ///< shown part of an unknown name, in messages

std::string find_scene(std::string& text) {
  std::error_code error;
  const auto status = std::filesystem::status(text, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_directory(status))
    return {};
  const std::vector<std::string> names = shipped_scenes();
  if (!std::ranges::binary_search(names, text))
    return fmt::format("'{}' is neither a file nor a shipped scene. Shipped scenes: {}",
                       text.substr(0, kMaxPrintedName), fmt::join(names, ", "));
  text = shipped_file("scenes", text).string();
  return {};
}

}  // namespace

std::vector<std::string> shipped_scenes() { return shipped_files("scenes"); }

CLI::Validator scene_argument() { return {find_scene, "FILE|NAME", "scene"}; }

}  // namespace voxtouch::runtime
