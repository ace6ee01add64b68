#pragma once
/// metadata.yaml of a rosbag2 folder, with the type hashes that Jazzy lists. Humble writes version
/// 5; it reads this version and ignores unknown keys. BagReader reads versions 1 to 9.
#include <cstdint>
#include <string>
#include <vector>

namespace voxtouch::bag {

/// The newest that has QoS as one text, which Humble needs.
inline constexpr int kMetadataVersion = 8;

/// A topic as bag and metadata name it: ROS names.
struct TopicInfo {
  std::string name;  ///< "/haptic/device/state"
  std::string type;  ///< "voxtouch_msgs/msg/DeviceState"
  std::string serialization_format = "cdr";
  /// of the writers, as YAML text: rmw's numbers up to version 8, the list of version 9 unchanged
  std::string offered_qos;
  std::uint64_t message_count = 0;
  std::string type_hash = {};  ///< RIHS01 hash of the type's layout
  std::string definition =
      {};  ///< the type's .msg with all types that it uses ("ros2msg"), stored in an MCAP
};

/// When messages were, and how many.
struct Extent {
  std::int64_t starting_time_ns = 0;  ///< of the first message; 0 without messages
  std::int64_t duration_ns = 0;       ///< last minus first
  std::uint64_t message_count = 0;
  /// Extends this to cover both; `more` without messages changes nothing.
  void add(const Extent& more) noexcept;
};

struct FileInfo : Extent {
  std::string path = {};  ///< relative to the folder
};

struct BagMetadata : Extent {
  std::string storage_identifier = "sqlite3";
  std::vector<TopicInfo> topics;
  std::vector<FileInfo> files;
};

/// The text of metadata.yaml. Without `with_root` only the inner part, as stored in the database's
/// metadata table; without that row Jazzy assumes its newest form of the QoS text.
std::string metadata_yaml(const BagMetadata& metadata, bool with_root = true);

}  // namespace voxtouch::bag
