#pragma once
/// Names of topics as ROS 2 has them.
#include <cstddef>
#include <string>
#include <string_view>

namespace voxtouch::effects {

inline constexpr std::string_view kRosTopicPattern = "^(/[A-Za-z_][A-Za-z0-9_]*)+$";
inline constexpr std::size_t kLongestTopic = 128;

/// Empty where `name` is an absolute topic of at most kLongestTopic characters, as the pattern has
/// it. Else what is wrong with it, to follow the name: "does not begin ...".
std::string fault_of_ros_topic(std::string_view name);

}  // namespace voxtouch::effects
