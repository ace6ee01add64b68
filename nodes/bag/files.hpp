#pragma once
/// Files that are whole at every instant.
#include <filesystem>
#include <string_view>

#include "nodes/bag/error.hpp"

namespace voxtouch::bag {

/// Durability on a loss of power: kNo leaves it to the operating system, kYes waits for the disk,
/// which may take seconds.
enum class Flush { kNo, kYes };

/// Replaces the content of `path` atomically: a reader, or a kill, finds the old text or the new
/// one. Error: the disk refuses it.
Result<void> write_atomically(const std::filesystem::path& path, std::string_view text,
                              Flush flush);

}  // namespace voxtouch::bag
