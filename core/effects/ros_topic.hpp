#pragma once
/// Topic names of ROS 2.
#include <cstddef>
#include <string>
#include <string_view>

namespace voxtouch::effects {

inline constexpr std::string_view kRosTopicPattern = "^(/[A-Za-z_][A-Za-z0-9_]*)+$";
inline constexpr std::size_t kLongestTopic = 128;

/// Checks that `name` is an absolute topic of at most kLongestTopic characters that matches the
/// pattern. Returns an empty text, or the fault as a continuation of the name: "does not begin
/// ...".
std::string fault_of_ros_topic(std::string_view name);

}  // namespace voxtouch::effects
