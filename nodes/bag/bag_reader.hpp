#pragma once
/// Reads rosbag2 folders (sqlite3, mcap; metadata versions 1 to 9), voxtouch's and those of `ros2
/// bag record`, also split ones. It also reads folders after a kill, with a missing or outdated
/// metadata.yaml: the content of the files counts.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nodes/bag/bag_metadata.hpp"
#include "nodes/bag/bag_storage.hpp"
#include "nodes/bag/file_reader.hpp"

namespace voxtouch::bag {

/// Allocates and waits for the disk; one thread at a time.
class BagReader {
 public:
  /// `path`: the folder, or one of its files. Errors: not found, compressed as a whole, unknown
  /// storage, not a bag.
  static Result<BagReader> open(const std::filesystem::path& path);

  /// Of the first file.
  Storage storage() const noexcept { return storage_; }
  /// Topics of all files, by name. Messages are not counted, which would take seconds for minutes
  /// of a ring: message_count is 0.
  const std::vector<TopicInfo>& topics() const noexcept { return topics_; }

  /// Data that metadata.yaml states and the files do not hold, as sentences: a missing file, a file
  /// with fewer messages.
  const std::vector<std::string>& losses() const noexcept { return losses_; }
  /// Messages in all files; a file that does not state its number counts as 0.
  std::uint64_t message_count() const noexcept { return message_count_; }

  /// Calls f for every message that was recorded from `from_ns` on and before `to_ns`, file by
  /// file, by time and then by id; f returns false to stop. Quick, wherever that lies. Errors: a
  /// damaged file.
  Result<void> for_each_between(std::int64_t from_ns, std::int64_t to_ns,
                                const TakeMessage& f) const;
  /// Times of the first and the last message; empty without messages.
  Result<std::optional<std::pair<std::int64_t, std::int64_t>>> times() const;

 private:
  struct File {
    std::unique_ptr<FileReader> reader;
    std::vector<std::size_t> topics;  ///< of its topics, the index into topics_
    std::filesystem::path path;
  };
  std::optional<std::size_t> find_topic(std::string_view name) const noexcept;
  Result<void> add_file(const std::filesystem::path& file);
  struct Described;
  void compare(const std::filesystem::path& folder, const Described& metadata);

  std::vector<File> files_;
  Storage storage_ = Storage::kMcap;
  std::vector<TopicInfo> topics_;
  std::vector<std::string> losses_;
  std::uint64_t message_count_ = 0;
};

}  // namespace voxtouch::bag
