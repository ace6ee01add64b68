#include "nodes/runtime/ros_arguments.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

namespace voxtouch::runtime {
namespace {

constexpr std::string_view kNamespace = "__ns:=";

[[noreturn]] void refuse(const std::string& what, const std::string& why) {
  throw CLI::ValidationError("--ros-args",
                             fmt::format("'{}' is not supported: {}", what.substr(0, 128), why));
}

std::string rig_of(const std::string& remap) {
  const std::string name = remap.substr(kNamespace.size());
  if (name.size() < 2 || name[0] != '/' || name.find('/', 1) != std::string::npos)
    refuse(remap, "a rig's namespace is '/' and one name, as in __ns:=/left");
  return name.substr(1);
}

/// Translates one option behind `--ros-args` that takes a value.
std::vector<std::string> translated(const std::string& option, const std::string& value) {
  if (option != "-r" && option != "--remap") {
    if (option == "-p" || option == "--param" || option == "--params-file")
      refuse(option + " " + value,
             "set parameters in the scene file, or with `ros2 param set` while the ring runs");
    refuse(option,
           "the only supported ROS argument is a namespace remapping (-r __ns:=/left), which "
           "selects the rig");
  }
  if (value.starts_with(kNamespace))
    return {"--rig", rig_of(value)};
  if (value.find("__node:=") != std::string::npos || value.find("__name:=") != std::string::npos)
    refuse(value, "node names are fixed; -r __ns:=/left selects the rig");
  refuse(value, "topic names are fixed; -r __ns:=/left selects the rig, their namespace");
}

}  // namespace

std::vector<std::string> without_ros_arguments(int argc, const char* const* argv) {
  std::vector<std::string> all, ours;
  for (int n = 1; n < argc; ++n)
    all.emplace_back(argv[n]);
  bool is_ros = false;
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (all[n] == "--ros-args") {
      is_ros = true;
    } else if (is_ros && all[n] == "--") {
      is_ros = false;
    } else if (is_ros) {
      const std::string option = all[n];
      const std::string value =
          n + 1 < all.size() && all[n + 1] != "--" && all[n + 1] != "--ros-args" ? all[++n] : "";
      for (std::string& word : translated(option, value))
        ours.push_back(std::move(word));
    } else {
      ours.push_back(all[n]);
    }
  }
  return ours;
}

}  // namespace voxtouch::runtime
