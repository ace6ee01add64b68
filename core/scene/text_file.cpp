#include "core/scene/text_file.hpp"

#include <fmt/core.h>

#include <fstream>

namespace voxtouch::scene {

std::string read_text_file(const std::filesystem::path& file, std::string_view what) {
  std::error_code fault;
  const auto status = std::filesystem::status(file, fault);
  if (!std::filesystem::exists(status))
    throw SceneError(file, {}, fmt::format("The {} file does not exist.", what));
  if (std::filesystem::is_directory(status))
    throw SceneError(file, {}, fmt::format("This is a folder. Choose the {} file in it.", what));
  if (!std::filesystem::is_regular_file(status))
    throw SceneError(file, {}, "This is not a regular file.");
  std::ifstream in(file, std::ios::binary);
  std::string text(kLargestTextFile + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (in.bad() || (in.fail() && !in.eof()))
    throw SceneError(file, {}, fmt::format("The {} file cannot be read.", what));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() > kLargestTextFile)
    throw SceneError(file, {},
                     fmt::format("The file is larger than {} bytes, the limit of a {} file.",
                                 kLargestTextFile, what));
  return text;
}

}  // namespace voxtouch::scene
