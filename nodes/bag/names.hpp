#pragma once
/// Names of topics and types as DDS carries them and as ROS 2 tools show them, and QoS as rosbag2 stores it.
#include <span>
#include <string>
#include <string_view>

#include "nodes/bus/opaque_qos.hpp"

namespace voxtouch::bag {

/// "rt/haptic/device/state" -> "/haptic/device/state". A name without the prefix stays, with a leading slash.
std::string ros_topic_name(std::string_view dds_name);
/// "/haptic/device/state" -> "rt/haptic/device/state".
std::string dds_topic_name(std::string_view ros_name);

/// "voxtouch_msgs::msg::dds_::DeviceState_" -> "voxtouch_msgs/msg/DeviceState". Anything else comes back as
/// it is.
std::string ros_type_name(std::string_view dds_name);
/// "voxtouch_msgs/msg/DeviceState" -> "voxtouch_msgs::msg::dds_::DeviceState_".
std::string dds_type_name(std::string_view ros_name);

/// The text that metadata version 4 to 8 stores for the writers of a topic: a YAML list with rmw's numbers.
/// Empty without writers.
std::string offered_qos_text(std::span<const bus::EndpointQos> writers);

}  // namespace voxtouch::bag
