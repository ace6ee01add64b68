#pragma once
/// Reads rosbag2 folders (sqlite3, uncompressed, metadata versions 1 to 9), voxtouch's own and those of `ros2
/// bag record`, also after a kill and with a metadata.yaml that is missing or stale: what stands in the
/// database counts.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nodes/bag/bag_metadata.hpp"
#include "nodes/bag/sqlite.hpp"

namespace voxtouch::bag {

/// A message inside the reader, until the callback returns.
struct BagMessage {
  std::size_t topic = 0;  ///< index into topics()
  std::int64_t time_ns = 0;
  std::int64_t id = 0;               ///< order of arrival within one file
  std::span<const std::byte> bytes;  ///< CDR with its 4-byte encapsulation header
};

/// Allocates and waits for the disk; one thread at a time.
class BagReader {
 public:
  /// `path`: the folder, or one .db3. Errors: nothing there, compressed, mcap, no database at all.
  static Result<BagReader> open(const std::filesystem::path& path);

  /// Topics of all files, by name. Messages are not counted, which would take seconds for minutes of a ring: message_count is 0.
  const std::vector<TopicInfo>& topics() const noexcept { return topics_; }

  /// Calls f for every message that was recorded from `from_ns` on and before `to_ns`, file by file, by time and then by id; f
  /// returns false to stop. Quick, wherever that lies. Errors: a damaged database.
  Result<void> for_each_between(std::int64_t from_ns, std::int64_t to_ns, const std::function<bool(const BagMessage&)>& f) const;
  /// Times of the first and of the last message; nothing where there is none.
  Result<std::optional<std::pair<std::int64_t, std::int64_t>>> times() const;
 private:
  struct File {
    Database database;
    std::vector<std::pair<std::int64_t, std::size_t>> topics;  // row in this file, index into topics_
    std::optional<std::size_t> index_of(std::int64_t row) const noexcept;
  };
  Result<bool> hand_out(const File& file, Statement& rows, const std::function<bool(const BagMessage&)>& f) const;
  std::optional<std::size_t> find_topic(std::string_view name) const noexcept;
  Result<void> add_file(const std::filesystem::path& file);

  std::vector<File> files_;
  std::vector<TopicInfo> topics_;
};

}  // namespace voxtouch::bag
