#pragma once
/// Translates the arguments behind `--ros-args` that ROS 2 adds to a launched program.
#include <string>
#include <vector>

namespace voxtouch::runtime {

/// Returns the command line with the part behind `--ros-args` (up to `--` or the end) translated. A
/// namespace remapping `-r __ns:=/left` becomes `--rig left`. Throws CLI::ValidationError, with a
/// sentence, for any other argument there; none is ignored.
std::vector<std::string> without_ros_arguments(int argc, const char* const* argv);

}  // namespace voxtouch::runtime
