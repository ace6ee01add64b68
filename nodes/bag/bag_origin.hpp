#pragma once
/// Which version recorded a bag, and whether this one can read its messages: what the logger
/// reports of itself next to the bag.
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace voxtouch::bag {

/// The hash of a type's layout as this version has it, by the type's ROS name; empty for a type
/// that it does not know.
using HashOf = std::function<std::string_view(std::string_view type)>;

/// Empty where the bag's messages are laid out as here. Else a sentence that names the version that
/// recorded it and the types that have changed since. A bag that states no hashes, an older one or
/// one of `ros2 bag record`, may be tried. Never throws for a faulty file.
std::string other_layout_error(const std::filesystem::path& bag, const HashOf& hash_of);

}  // namespace voxtouch::bag
