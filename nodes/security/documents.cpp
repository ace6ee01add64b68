#include "nodes/security/documents.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "qos/services.hpp"

namespace voxtouch::security {
namespace {

/// The role's bit in the table's columns; kNone if it is not a node of the ring.
qos::Nodes node_of(std::string_view role) {
  for (qos::Nodes bit = 1; bit & qos::kEveryNode; bit = static_cast<qos::Nodes>(bit << 1U))
    if (qos::names_of(bit).front() == role)
      return bit;
  return qos::kNone;
}

bool writes(std::string_view role, const qos::Topic& topic) {
  if (role == kLauncher)
    return topic.writers == qos::kEveryNode || topic.of_launcher;
  if (role == kTool)
    return topic.writers == qos::kNone && !topic.of_launcher && !topic.with_led_hand;
  return (topic.writers & node_of(role)) != 0;
}

bool reads_all(std::string_view role) {
  return role == kLauncher || role == kTool || node_of(role) == qos::kLogger;
}

/// Nodes are shown to ROS 2 tools over it (nodes/bus/graph.hpp), by every participant.
constexpr std::string_view kGraph = "ros_discovery_info";

std::string topics_xml(const std::vector<std::string>& names) {
  std::string xml;
  for (const std::string& name : names)
    xml += fmt::format("          <topic>{}</topic>\n", name);
  return xml;
}

}  // namespace

std::vector<std::string> roles() {
  std::vector<std::string> all = qos::names_of(qos::kEveryNode);
  all.emplace_back(kLauncher);
  all.emplace_back(kTool);
  return all;
}

std::string role_of(std::string_view name) {
  return std::string(std::ranges::count(roles(), name) ? name : kTool);
}

std::string common_name(std::string_view role, std::string_view rig) {
  return fmt::format("{}.{}", rig, role);
}

/// Domains 231 and 232 are not to be had: the parser of Cyclone DDS takes none above 230.
std::string governance() {
  // Protection of submessages suffices for a message and covers its header too: without the keys
  // it cannot be read, and no heartbeat or gap can be forged. Protection of the payload only would
  // allow forged ones. qos/README.md has the costs.
  return R"(<?xml version="1.0" encoding="UTF-8"?>
<dds><domain_access_rules><domain_rule>
  <domains><id_range><min>0</min><max>230</max></id_range></domains>
  <allow_unauthenticated_participants>false</allow_unauthenticated_participants>
  <enable_join_access_control>true</enable_join_access_control>
  <discovery_protection_kind>ENCRYPT</discovery_protection_kind>
  <liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
  <rtps_protection_kind>NONE</rtps_protection_kind>
  <topic_access_rules><topic_rule>
    <topic_expression>*</topic_expression>
    <enable_discovery_protection>true</enable_discovery_protection>
    <enable_liveliness_protection>true</enable_liveliness_protection>
    <enable_read_access_control>true</enable_read_access_control>
    <enable_write_access_control>true</enable_write_access_control>
    <metadata_protection_kind>ENCRYPT</metadata_protection_kind>
    <data_protection_kind>NONE</data_protection_kind>
  </topic_rule></topic_access_rules>
</domain_rule></domain_access_rules></dds>
)";
}

std::string permissions(std::string_view role, std::string_view rig, std::string_view from,
                        std::string_view until) {
  std::vector<std::string> written{std::string(kGraph)},
      read{std::string(reads_all(role) ? "*" : kGraph)};
  for (const qos::Topic& topic : qos::kTopics) {
    if (writes(role, topic))
      written.push_back(qos::dds_name(topic, rig));
    if (!reads_all(role) && (topic.readers & node_of(role)) != 0)
      read.push_back(qos::dds_name(topic, rig));
  }
  for (const qos::Service& service : qos::kServices)
    for (const std::string& node : qos::names_of(service.servers)) {
      if (role == kTool)
        written.push_back(qos::request_name(service, rig, node));
      if (role != node)
        continue;
      written.push_back(qos::reply_name(service, rig, node));
      if (!reads_all(role))
        read.push_back(qos::request_name(service, rig, node));
    }
  return fmt::format(R"(<?xml version="1.0" encoding="UTF-8"?>
<dds><permissions><grant name="{0}">
  <subject_name>CN={0}</subject_name>
  <validity><not_before>{1}</not_before><not_after>{2}</not_after></validity>
  <allow_rule>
    <domains><id_range><min>0</min><max>230</max></id_range></domains>
    <publish><topics>
{3}    </topics></publish>
    <subscribe><topics>
{4}    </topics></subscribe>
  </allow_rule>
  <default>DENY</default>
</grant></permissions></dds>
)",
                     common_name(role, rig), from, until, topics_xml(written), topics_xml(read));
}

}  // namespace voxtouch::security
