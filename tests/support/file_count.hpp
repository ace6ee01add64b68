#pragma once
#include <filesystem>
#include <iterator>

namespace voxtouch::test {

/// How many files and folders a folder holds, not counting what is within them.
inline std::size_t file_count(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

}  // namespace voxtouch::test
