#pragma once
/// What ROS 2 puts behind `--ros-args` of a program that it launches.
#include <string>
#include <vector>

namespace voxtouch::runtime {

/// The command line without its part behind `--ros-args` (up to `--`, or the end): a remapping of
/// the namespace, `-r __ns:=/left`, has become
/// `--rig left`. Throws CLI::ValidationError, a sentence, that names what else stands there:
/// nothing of it is passed over in silence.
std::vector<std::string> without_ros_arguments(int argc, const char* const* argv);

}  // namespace voxtouch::runtime
