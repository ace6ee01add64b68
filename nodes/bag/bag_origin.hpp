#pragma once
/// Which version recorded a bag, and whether this version can read its messages. The logger writes
/// this next to the bag.
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace voxtouch::bag {

/// The hash of a type's layout in this version, by its ROS name; empty for an unknown type.
using HashOf = std::function<std::string_view(std::string_view type)>;

/// Empty if the bag's messages have this version's layouts. Otherwise a sentence with the recording
/// version and the changed types. A bag without hashes, such as one of `ros2 bag record`, may be
/// tried. Never throws for a faulty file.
std::string other_layout_error(const std::filesystem::path& bag, const HashOf& hash_of);

}  // namespace voxtouch::bag
