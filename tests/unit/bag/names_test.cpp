#include "nodes/bag/names.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace voxtouch::bag {

TEST(BagNames, TopicsLoseTheirPrefixAndGetItBack) {
  EXPECT_EQ(ros_topic_name("rt/haptic/device/state"), "/haptic/device/state");
  EXPECT_EQ(dds_topic_name("/haptic/device/state"), "rt/haptic/device/state");
  EXPECT_EQ(ros_topic_name("ros_discovery_info"), "/ros_discovery_info");
}

TEST(BagNames, TypesLoseTheirInnerModuleAndGetItBack) {
  EXPECT_EQ(ros_type_name("voxtouch_msgs::msg::dds_::DeviceState_"), "voxtouch_msgs/msg/DeviceState");
  EXPECT_EQ(dds_type_name("voxtouch_msgs/msg/DeviceState"), "voxtouch_msgs::msg::dds_::DeviceState_");
  EXPECT_EQ(ros_type_name("SomeBody::Elses"), "SomeBody::Elses");
}

TEST(BagNames, QosTextIsWhatHumbleWrites) {
  bus::EndpointQos qos;
  qos.reliability = bus::Reliability::kReliable;
  qos.durability = bus::Durability::kTransientLocal;
  qos.depth = 7;
  qos.deadline_ns = 3'000'000;
  const std::vector<bus::EndpointQos> writers{qos};
  EXPECT_EQ(offered_qos_text(writers),
            "- history: 1\n  depth: 7\n  reliability: 1\n  durability: 1\n"
            "  deadline:\n    sec: 0\n    nsec: 3000000\n"
            "  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n  liveliness: 1\n"
            "  liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n"
            "  avoid_ros_namespace_conventions: false");
  EXPECT_EQ(offered_qos_text({}), "");
}

TEST(BagNames, QosTextHoldsAllWritersAndTheOtherPolicies) {
  bus::EndpointQos all;
  all.history = bus::History::kKeepAll;
  all.liveliness = bus::Liveliness::kManualByTopic;
  const std::vector<bus::EndpointQos> writers{all, {}};
  const std::string text = offered_qos_text(writers);
  EXPECT_TRUE(text.starts_with("- history: 2\n  depth: 0\n  reliability: 2\n  durability: 2\n")) << text;
  EXPECT_NE(text.find("liveliness: 3\n"), std::string::npos);
  EXPECT_NE(text.find("\n- history: 1\n  depth: 1\n"), std::string::npos);
}

}  // namespace voxtouch::bag
