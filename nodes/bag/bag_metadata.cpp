#include "nodes/bag/bag_metadata.hpp"

#include <algorithm>
#include <cstdlib>

#include <yaml-cpp/yaml.h>

namespace voxtouch::bag {
namespace {

YAML::Node topic_node(const TopicInfo& topic) {
  YAML::Node node;
  YAML::Node info = node["topic_metadata"];
  info["name"] = topic.name;
  info["type"] = topic.type;
  info["serialization_format"] = topic.serialization_format;
  info["offered_qos_profiles"] = topic.offered_qos;
  info["type_description_hash"] = topic.type_hash;
  node["message_count"] = topic.message_count;
  return node;
}

/// Metadata common to the bag and each of its files.
void add_extent(YAML::Node node, const Extent& extent) {
  node["duration"]["nanoseconds"] = extent.duration_ns;
  node["starting_time"]["nanoseconds_since_epoch"] = extent.starting_time_ns;
  node["message_count"] = extent.message_count;
}

}  // namespace

void Extent::add(const Extent& more) noexcept {
  if (more.message_count == 0)
    return;
  if (message_count == 0)
    return void(*this = more);
  const std::int64_t end =
      std::max(starting_time_ns + duration_ns, more.starting_time_ns + more.duration_ns);
  starting_time_ns = std::min(starting_time_ns, more.starting_time_ns);
  duration_ns = end - starting_time_ns;
  message_count += more.message_count;
}

std::string metadata_yaml(const BagMetadata& metadata, bool with_root) {
  YAML::Node root(YAML::NodeType::Map);  // an undefined node is not shared by its copies
  YAML::Node body = with_root ? root["rosbag2_bagfile_information"] : root;
  body["version"] = kMetadataVersion;
  body["storage_identifier"] = metadata.storage_identifier;
  add_extent(body, metadata);
  body["topics_with_message_count"] = YAML::Node(YAML::NodeType::Sequence);
  for (const TopicInfo& topic : metadata.topics)
    body["topics_with_message_count"].push_back(topic_node(topic));
  body["compression_format"] = "";
  body["compression_mode"] = "";
  for (const FileInfo& one : metadata.files) {
    YAML::Node file;
    file["path"] = one.path;
    add_extent(file, one);
    body["relative_file_paths"].push_back(one.path);
    body["files"].push_back(file);
  }
  body["custom_data"] = YAML::Node(YAML::NodeType::Map);
  const char* const distribution = std::getenv("ROS_DISTRO");
  body["ros_distro"] = distribution && *distribution ? distribution : "unknown";
  return YAML::Dump(root) + "\n";
}

}  // namespace voxtouch::bag
