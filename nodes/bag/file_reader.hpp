#pragma once
/// One file of a bag that is read. There is one for each storage; BagReader puts the files of a bag
/// together.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "nodes/bag/bag_metadata.hpp"
#include "nodes/bag/error.hpp"

namespace voxtouch::bag {

/// A message inside the reader, until the callback returns.
struct BagMessage {
  std::size_t topic = 0;  ///< index into topics() of the file or bag that returned it
  std::int64_t time_ns = 0;
  std::int64_t id = 0;               ///< order of arrival within one file
  std::span<const std::byte> bytes;  ///< CDR with its 4-byte encapsulation header
};
/// Returns false to stop.
using TakeMessage = std::function<bool(const BagMessage&)>;

class FileReader {
 public:
  virtual ~FileReader() = default;
  const std::vector<TopicInfo>& topics() const noexcept { return topics_; }
  /// Messages recorded from `from_ns` on and before `to_ns`, by time and then by id; false if f
  /// returned false. Errors: a damaged file.
  virtual Result<bool> for_each_between(std::int64_t from_ns, std::int64_t to_ns,
                                        const TakeMessage& f) const = 0;
  /// Times of the first and the last message; empty without messages.
  virtual Result<std::optional<std::pair<std::int64_t, std::int64_t>>> times() const = 0;
  /// Number of messages; empty if the file does not state it.
  virtual std::optional<std::uint64_t> message_count() const = 0;

 protected:
  std::vector<TopicInfo> topics_;
};

/// Errors: the file cannot be read, or is none of its kind.
Result<std::unique_ptr<FileReader>> open_sqlite_file(const std::filesystem::path& path);
Result<std::unique_ptr<FileReader>> open_mcap_file(const std::filesystem::path& path);
/// Whether the file begins as an MCAP does.
bool is_mcap(const std::filesystem::path& path);

}  // namespace voxtouch::bag
