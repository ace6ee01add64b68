#pragma once
/// Writes a rosbag2 folder: metadata.yaml (version 8) and <name>_0.mcap or <name>_0.db3 (sqlite3,
/// schema 3), then _1 and so on if split. Humble and Jazzy read it.
///
/// Nothing is flushed to the disk before the bag is closed, as in rosbag2's default. Flushes of 0.3
/// to 1.2 s were measured on a disk shared by two rings. A kill of any process loses 0.2 s at most;
/// a loss of power while recording may lose the bag. A closed bag is on the disk.
#include <chrono>
#include <filesystem>
#include <limits>
#include <memory>

#include "nodes/bag/bag_file.hpp"
#include "nodes/bag/bag_storage.hpp"

namespace voxtouch::bag {

/// When a bag continues in a new file; 0: no limit. Every file has all topics, and the messages
/// written while it was open.
struct SplitOptions {
  std::uint64_t bytes = 0;   ///< a new file begins at about this size
  std::int64_t time_ns = 0;  ///< a new file begins after this time in the bag
};

struct WriterOptions {
  std::chrono::milliseconds commit_period{
      200};  ///< a kill loses at most the messages of this period
  std::chrono::milliseconds refresh_period{500};  ///< metadata.yaml; sqlite3: checkpoint
  /// of a file; beyond it messages are lost as on a full disk; 0: no limit
  std::uint64_t max_bytes = 0;
  Storage storage = Storage::kMcap;
  SplitOptions split = {};
  bool folder_is_made = false;  ///< by the caller, for this bag: the folder is there and empty
};

/// Not thread-safe. Blocks for the disk: never call it from a DDS listener; BagRecorder is for
/// that.
class BagWriter final : public BagSink {
 public:
  /// Makes `folder` (parents as well), the empty bag and its metadata. Errors: anything is there
  /// already, or in a folder that is made, which is then untouched; the disk refuses.
  static Result<BagWriter> create(const std::filesystem::path& folder,
                                  const WriterOptions& options = {});
  BagWriter(BagWriter&&) = default;
  BagWriter& operator=(BagWriter&&) = delete;
  ~BagWriter() override;  ///< closes; its errors go unseen, so close() first

  Result<TopicId> add_topic(const TopicInfo& topic) override;
  Result<void> append(TopicId topic, std::int64_t time_ns,
                      std::span<const std::byte> bytes) override;
  Result<void> tick() override;
  void fill_counts(std::vector<TopicReport>& topics) const override;
  Result<void> report(const RecordingReport& report) override;
  Result<void> close() override;

  Result<void> commit();   ///< at once
  Result<void> refresh();  ///< Commits, and writes metadata.yaml and the file's index.
  const BagMetadata& metadata() const noexcept { return metadata_; }  ///< of the committed messages

 private:
  struct Topic {
    std::uint64_t pending = 0, lost = 0;  // pending: not committed yet
  };
  // A file at its creation, with the size that it must have.
  struct Made {
    std::uint64_t device = 0, inode = 0, bytes = 0;
    std::vector<std::uint64_t> messages;  // of each topic
    bool is_cut = false;                  // seen before more was written behind the cut
    bool lost = false;
  };
  using Clock = std::chrono::steady_clock;
  BagWriter(std::filesystem::path folder, const WriterOptions& options)
      : folder_(std::move(folder)),
        options_(options) {}
  /// The next one, with all topics; the one before is closed.
  Result<void> open_file();
  Result<std::unique_ptr<BagFile>> make_file(const std::string& name) const;
  bool is_to_be_split(std::int64_t time_ns, std::size_t bytes) const noexcept;
  Result<void> write_metadata(Flush flush) const;
  void count_committed();
  /// Whether a file was replaced or has fewer bytes than were written. Such a file is counted as
  /// lost, once.
  bool is_cut(std::size_t file) const;
  Result<void> check_files();
  void drop_pending();

  std::filesystem::path folder_;
  WriterOptions options_;
  std::unique_ptr<BagFile> file_;  // null once closed or moved from
  BagMetadata metadata_;
  std::int64_t file_begun_ns_ = 0;  // the time of the message that the file was opened for
  std::vector<Topic> topics_;
  std::vector<Made> made_;  // as metadata_.files
  struct Pending {
    std::int64_t first_ns = std::numeric_limits<std::int64_t>::max(), last_ns = 0;
    std::uint64_t messages = 0, bytes = 0;
  } pending_;
  Clock::time_point last_commit_ = Clock::now(), last_refresh_ = last_commit_,
                    last_split_refusal_{};
};

}  // namespace voxtouch::bag
