#pragma once
/// One file of a bag while it is written. BagWriter counts, splits and describes; a file only
/// holds. There is one for each storage.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "nodes/bag/bag_metadata.hpp"
#include "nodes/bag/bag_sink.hpp"
#include "nodes/bag/error.hpp"
#include "nodes/bag/files.hpp"

namespace voxtouch::bag {

/// Not thread-safe; blocks for the disk. After an error the next calls are still made: a disk that
/// has room again is used again.
class BagFile {
 public:
  virtual ~BagFile() = default;
  /// Topics are numbered from 0 in the order of these calls. Only called without pending messages.
  virtual Result<void> add_topic(const TopicInfo& topic) = 0;
  /// Buffers the message until commit(). `topic` was added, time_ns >= 0. On error this message is
  /// lost, and all pending ones if `pending` is false afterwards.
  virtual Result<void> append(TopicId topic, std::int64_t time_ns,
                              std::span<const std::byte> bytes) = 0;
  /// Whether messages wait for commit().
  virtual bool pending() const noexcept = 0;
  /// Whether so many messages wait that commit() is due.
  virtual bool is_full() const noexcept { return false; }
  /// Writes pending messages to the operating system: a later kill does not lose them. On error all
  /// pending messages are lost; those of earlier commits are intact.
  virtual Result<void> commit() = 0;
  /// Called at intervals: updates the data that readers need for a file that is still written or
  /// was left by a kill.
  virtual Result<void> refresh(const BagMetadata& metadata) = 0;
  /// Commits and ends the file, which may only be destroyed then. kYes: once it returns, the file
  /// is on the disk.
  virtual Result<void> close(const BagMetadata& metadata, Flush flush) = 0;
  virtual std::uint64_t bytes() const noexcept = 0;  ///< of the file at the last commit
};

/// Make the file, which must not be there. `max_bytes`: beyond them messages are lost as on a full
/// disk; 0: no limit. Errors: the disk refuses.
Result<std::unique_ptr<BagFile>> make_sqlite_file(const std::filesystem::path& path,
                                                  std::uint64_t max_bytes);
Result<std::unique_ptr<BagFile>> make_mcap_file(const std::filesystem::path& path,
                                                std::uint64_t max_bytes);

}  // namespace voxtouch::bag
