#pragma once
/// Files that are whole at every instant.
#include <filesystem>
#include <string_view>

#include "nodes/bag/error.hpp"

namespace voxtouch::bag {

/// What survives a loss of power: kNo leaves that to the operating system, kYes waits for the disk
/// (seconds, where it is busy).
enum class Flush { kNo, kYes };

/// Replaces `path` by `text`: written next to it, then put in its place in one step, so that a
/// reader sees the old text or the new one and a kill leaves one of the two. Error: the disk
/// refuses it.
Result<void> write_atomically(const std::filesystem::path& path, std::string_view text,
                              Flush flush);

}  // namespace voxtouch::bag
