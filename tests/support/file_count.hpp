#pragma once
#include <filesystem>
#include <iterator>

namespace voxtouch::test {

/// Number of entries of a folder, not recursive.
inline std::size_t file_count(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

}  // namespace voxtouch::test
