#pragma once
/// Files that are whole at every instant.
#include <filesystem>
#include <string_view>

#include "nodes/bag/error.hpp"

namespace voxtouch::bag {

/// Replaces `path` by `text`: written beside it, flushed to the disk, then renamed over it, so that a reader
/// sees the old text or the new one and a kill leaves one of the two. Blocks for the disk. Error: kDisk.
Result<void> write_atomically(const std::filesystem::path& path, std::string_view text);

}  // namespace voxtouch::bag
