#include "nodes/bag/bag_metadata.hpp"

#include <yaml-cpp/yaml.h>

namespace voxtouch::bag {
namespace {

template <class T>
void emit_time(YAML::Emitter& out, const char* name, const char* unit, T value) {
  out << YAML::Key << name << YAML::Value << YAML::BeginMap << YAML::Key << unit << YAML::Value << value
      << YAML::EndMap;
}

void emit_topics(YAML::Emitter& out, const std::vector<TopicInfo>& topics) {
  out << YAML::Key << "topics_with_message_count" << YAML::Value << YAML::BeginSeq;
  for (const auto& topic : topics) {
    out << YAML::BeginMap << YAML::Key << "topic_metadata" << YAML::Value << YAML::BeginMap;
    out << YAML::Key << "name" << YAML::Value << topic.name << YAML::Key << "type" << YAML::Value << topic.type;
    out << YAML::Key << "serialization_format" << YAML::Value << topic.serialization_format;
    out << YAML::Key << "offered_qos_profiles" << YAML::Value << YAML::DoubleQuoted << topic.offered_qos
        << YAML::EndMap;
    out << YAML::Key << "message_count" << YAML::Value << topic.message_count << YAML::EndMap;
  }
  out << YAML::EndSeq;
}

void emit_files(YAML::Emitter& out, const BagMetadata& metadata) {
  out << YAML::Key << "relative_file_paths" << YAML::Value << YAML::BeginSeq;
  for (const auto& file : metadata.files) out << file;
  out << YAML::EndSeq << YAML::Key << "files" << YAML::Value << YAML::BeginSeq;
  for (const auto& file : metadata.files) {
    out << YAML::BeginMap << YAML::Key << "path" << YAML::Value << file;
    emit_time(out, "starting_time", "nanoseconds_since_epoch", metadata.starting_time_ns);
    emit_time(out, "duration", "nanoseconds", metadata.duration_ns);
    out << YAML::Key << "message_count" << YAML::Value << metadata.message_count << YAML::EndMap;
  }
  out << YAML::EndSeq;
}

void emit_body(YAML::Emitter& out, const BagMetadata& metadata) {
  out << YAML::BeginMap << YAML::Key << "version" << YAML::Value << 5;
  out << YAML::Key << "storage_identifier" << YAML::Value << metadata.storage_identifier;
  emit_time(out, "duration", "nanoseconds", metadata.duration_ns);
  emit_time(out, "starting_time", "nanoseconds_since_epoch", metadata.starting_time_ns);
  out << YAML::Key << "message_count" << YAML::Value << metadata.message_count;
  emit_topics(out, metadata.topics);
  out << YAML::Key << "compression_format" << YAML::Value << YAML::DoubleQuoted << "";
  out << YAML::Key << "compression_mode" << YAML::Value << YAML::DoubleQuoted << "";
  emit_files(out, metadata);
  out << YAML::EndMap;
}

}  // namespace

std::string metadata_yaml(const BagMetadata& metadata, bool with_root) {
  YAML::Emitter out;
  if (with_root) out << YAML::BeginMap << YAML::Key << "rosbag2_bagfile_information" << YAML::Value;
  emit_body(out, metadata);
  if (with_root) out << YAML::EndMap;
  return std::string(out.c_str()) + "\n";
}

}  // namespace voxtouch::bag
