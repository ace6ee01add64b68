#pragma once
/// Writes a rosbag2 folder: metadata.yaml (version 5) and <name>_0.db3 (sqlite3, schema 3), readable by
/// Humble and Jazzy.
///
/// Journal: write-ahead log while recording, as rosbag2's own resilient profile has it. Reason: rosbag2 opens
/// bags read-only, and a read-only connection cannot undo the rollback journal that a kill in the middle of a
/// transaction leaves behind (of 25 killed writers each, journal mode DELETE left 4 that opened, TRUNCATE 2,
/// WAL 25), but it reads a write-ahead log. So after a kill the folder holds <name>_0.db3-wal (and -shm)
/// besides the .db3: keep them together; the .db3 alone lacks what was committed since the last checkpoint
/// (`refresh_period`). Closing folds the log in and turns the journal back, so that a closed bag is one file
/// that opens on read-only media too.
///
/// Nothing is flushed to the disk before the bag is closed, as in rosbag2's own default: flushes of 0.3 to 1.2 s
/// were seen on a disk that two rings shared, as long as a hung logger. So a kill of any process loses 0.2 s at
/// most, but a loss of power while recording may cost the bag; a closed one is on the disk.
#include <chrono>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>

#include "nodes/bag/bag_sink.hpp"
#include "nodes/bag/files.hpp"
#include "nodes/bag/sqlite.hpp"

namespace voxtouch::bag {

struct WriterOptions {
  std::chrono::milliseconds commit_period{200};   ///< a kill loses at most what came since
  std::chrono::milliseconds refresh_period{500};  ///< metadata.yaml, checkpoint
  /// of the .db3; beyond it messages are lost as on a full disk; 0: no limit
  std::uint64_t max_bytes = 0;
};

/// Not thread-safe. Blocks for the disk: never call it from a DDS listener; BagRecorder is for that.
class BagWriter final : public BagSink {
 public:
  /// Makes `folder` (parents as well), the empty bag and its metadata. Errors: anything is there already,
  /// which is then untouched; the disk refuses.
  static Result<BagWriter> create(const std::filesystem::path& folder, const WriterOptions& options = {});
  BagWriter(BagWriter&&) = default;
  BagWriter& operator=(BagWriter&&) = delete;
  ~BagWriter() override;  ///< closes; its errors go unseen, so close() first

  Result<TopicId> add_topic(const TopicInfo& topic) override;
  Result<void> append(TopicId topic, std::int64_t time_ns, std::span<const std::byte> bytes) override;
  Result<void> tick() override;
  void fill_counts(std::vector<TopicReport>& topics) const override;
  Result<void> report(const RecordingReport& report) override;
  Result<void> close() override;

  Result<void> commit();                                              ///< at once
  Result<void> refresh();                                             ///< commit, checkpoint, metadata.yaml, at once
  const BagMetadata& metadata() const noexcept { return metadata_; }  ///< of what is committed

 private:
  struct Topic {
    std::int64_t row = 0;
    std::uint64_t pending = 0, lost = 0;  // pending: in the open transaction
  };
  using Clock = std::chrono::steady_clock;
  BagWriter(std::filesystem::path folder, const WriterOptions& options, Database database);
  Result<void> create_tables();
  Result<void> refresh(Flush flush);
  Result<void> begin();
  void commit_counts();
  void lose_pending();
  Result<void> write_metadata_row();

  std::filesystem::path folder_;
  WriterOptions options_;
  std::unique_ptr<Database> database_;  // null once closed or moved from
  std::optional<Statement> insert_;
  BagMetadata metadata_;
  std::vector<Topic> topics_;
  struct Pending {
    std::int64_t first_ns = std::numeric_limits<std::int64_t>::max(), last_ns = 0;
    std::uint64_t messages = 0;
  } pending_;  // what the open transaction holds
  bool in_transaction_ = false;
  Clock::time_point last_commit_, last_refresh_;
};

}  // namespace voxtouch::bag
