#pragma once
/// A recorded bag with the queries of tests: counts, metadata, the messages of a topic.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <limits>

#include "nodes/bag/bag_reader.hpp"

namespace voxtouch::bag {

/// A message on its own.
struct StoredMessage {
  std::int64_t time_ns = 0;
  std::vector<std::byte> bytes;
};

/// Content of metadata.yaml.
struct WholeMetadata : BagMetadata {
  int version = 0;
};

inline TopicInfo parse_topic(const YAML::Node& node) {
  TopicInfo topic;
  const YAML::Node inner = node["topic_metadata"];
  topic.name = inner["name"].as<std::string>();
  topic.type = inner["type"].as<std::string>();
  topic.serialization_format = inner["serialization_format"].as<std::string>();
  if (const YAML::Node qos = inner["offered_qos_profiles"])
    topic.offered_qos = qos.IsScalar() ? qos.Scalar() : YAML::Dump(qos);
  topic.message_count = node["message_count"].as<std::uint64_t>();
  return topic;
}

/// Errors: there is none, or it is not one.
inline Result<WholeMetadata> read_metadata(const std::filesystem::path& file) {
  try {
    const YAML::Node node = YAML::LoadFile(file.string())["rosbag2_bagfile_information"];
    WholeMetadata metadata;
    metadata.version = node["version"].as<int>();
    metadata.storage_identifier = node["storage_identifier"].as<std::string>();
    metadata.duration_ns = node["duration"]["nanoseconds"].as<std::int64_t>();
    metadata.starting_time_ns = node["starting_time"]["nanoseconds_since_epoch"].as<std::int64_t>();
    metadata.message_count = node["message_count"].as<std::uint64_t>();
    for (const auto& topic : node["topics_with_message_count"])
      metadata.topics.push_back(parse_topic(topic));
    for (const auto& one : node["files"])
      metadata.files.push_back({{one["starting_time"]["nanoseconds_since_epoch"].as<std::int64_t>(),
                                 one["duration"]["nanoseconds"].as<std::int64_t>(),
                                 one["message_count"].as<std::uint64_t>()},
                                one["path"].as<std::string>()});
    return metadata;
  } catch (const YAML::Exception& error) {
    return std::unexpected(BagError{error.what()});
  }
}

class WholeBag {
 public:
  /// As BagReader::open, and every message is counted.
  static Result<WholeBag> open(const std::filesystem::path& path) {
    auto reader = BagReader::open(path);
    if (!reader)
      return std::unexpected(reader.error());
    WholeBag bag(std::move(*reader));
    bag.topics_ = bag.reader_.topics();
    if (auto described = read_metadata(path / "metadata.yaml"))
      bag.metadata_ = std::move(*described);
    const auto counted = bag.for_each(
        [&](const BagMessage& message) { return ++bag.topics_[message.topic].message_count > 0; });
    if (!counted)
      return std::unexpected(counted.error());
    return bag;
  }

  const std::vector<TopicInfo>& topics() const noexcept { return topics_; }
  /// Content of metadata.yaml; empty if it is missing or unreadable. It may be up to a second old
  /// after a kill.
  const std::optional<WholeMetadata>& metadata() const noexcept { return metadata_; }
  std::optional<std::size_t> find_topic(std::string_view name) const noexcept {
    const auto found = std::ranges::find(topics_, name, &TopicInfo::name);
    return found == topics_.end()
               ? std::nullopt
               : std::optional(static_cast<std::size_t>(found - topics_.begin()));
  }
  std::uint64_t message_count() const noexcept {
    std::uint64_t count = 0;
    for (const TopicInfo& topic : topics_)
      count += topic.message_count;
    return count;
  }

  /// Every message, by time; f returns false to stop.
  Result<void> for_each(const std::function<bool(const BagMessage&)>& f) const {
    using Limits = std::numeric_limits<std::int64_t>;
    return reader_.for_each_between(Limits::min(), Limits::max(), f);
  }
  enum class Order : std::uint8_t { kTime, kArrival };  ///< the latter for bags of one file
  /// All messages of a topic. Error: unknown topic, with the list of topics.
  Result<std::vector<StoredMessage>> read_topic(std::string_view name,
                                                Order order = Order::kTime) const {
    const auto topic = find_topic(name);
    if (!topic)
      return std::unexpected(no_such_topic(name));
    std::vector<std::pair<std::int64_t, StoredMessage>> found;
    const auto read = for_each([&](const BagMessage& m) {
      if (m.topic == *topic)
        found.push_back({m.id, {m.time_ns, {m.bytes.begin(), m.bytes.end()}}});
      return true;
    });
    if (!read)
      return std::unexpected(read.error());
    if (order == Order::kArrival)
      std::ranges::stable_sort(found, {}, [](const auto& one) { return one.first; });
    std::vector<StoredMessage> messages;
    for (auto& [id, message] : found)
      messages.push_back(std::move(message));
    return messages;
  }

 private:
  explicit WholeBag(BagReader reader) : reader_(std::move(reader)) {}
  BagError no_such_topic(std::string_view name) const {
    std::vector<std::string> names;
    for (const TopicInfo& topic : topics_)
      names.push_back(topic.name);
    return {fmt::format("The bag has no topic '{}'. It has: {}.", name, fmt::join(names, ", "))};
  }

  BagReader reader_;
  std::vector<TopicInfo> topics_;
  std::optional<WholeMetadata> metadata_;
};

}  // namespace voxtouch::bag
