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
  /// Topics are numbered in the order of these calls, from 0. Only called where nothing is pending.
  virtual Result<void> add_topic(const TopicInfo& topic) = 0;
  /// Holds the message until commit() brings it to the operating system. `topic` was added, time_ns
  /// >= 0. Error: this message is lost, and all that is pending as well where `pending` says so
  /// afterwards.
  virtual Result<void> append(TopicId topic, std::int64_t time_ns,
                              std::span<const std::byte> bytes) = 0;
  virtual bool pending()
      const noexcept = 0;  ///< something was appended that commit() is still to bring in
  virtual bool is_full() const noexcept {
    return false;
  }  ///< so much is pending that commit() is called for
  /// A kill loses nothing of it from here on. Error: all that was pending is lost, and what was
  /// committed before is whole.
  virtual Result<void> commit() = 0;
  /// Now and then: what makes a file that is read while it is written, or left behind by a kill,
  /// better to read.
  virtual Result<void> refresh(const BagMetadata& metadata) = 0;
  /// Commits and ends the file, which may only be destroyed then. kYes: once it returns, the file
  /// is on the disk.
  virtual Result<void> close(const BagMetadata& metadata, Flush flush) = 0;
  virtual std::uint64_t bytes() const noexcept = 0;  ///< of the file as it was last committed
};

/// Make the file, which must not be there. `max_bytes`: beyond them messages are lost as on a full
/// disk; 0: no limit. Errors: the disk refuses.
Result<std::unique_ptr<BagFile>> make_sqlite_file(const std::filesystem::path& path,
                                                  std::uint64_t max_bytes);
Result<std::unique_ptr<BagFile>> make_mcap_file(const std::filesystem::path& path,
                                                std::uint64_t max_bytes);

}  // namespace voxtouch::bag
