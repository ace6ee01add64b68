#include "core/effects/ros_topic.hpp"

#include <fmt/core.h>

#include <cctype>

namespace voxtouch::effects {

std::string fault_of_ros_topic(std::string_view name) {
  if (name.size() > kLongestTopic)
    return fmt::format("is longer than {} characters", kLongestTopic);
  if (name.empty() || name.front() != '/')
    return "does not start with '/'; write an absolute name such as /sim/wrench";
  const auto letter = [](char c) {
    return c == '_' || std::isalpha(static_cast<unsigned char>(c)) != 0;
  };
  for (std::size_t n = 0; n < name.size(); ++n) {
    const char c = name[n];
    const bool first = n > 0 && name[n - 1] == '/';
    if (first ? !letter(c)
              : c != '/' && !letter(c) && std::isdigit(static_cast<unsigned char>(c)) == 0)
      return "is not a ROS 2 topic: its parts have letters, digits and '_', and do not start with "
             "a digit";
  }
  return name.back() == '/' ? "ends with '/'" : "";
}

}  // namespace voxtouch::effects
