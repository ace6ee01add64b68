/// A bag's file in sqlite3, schema 3, as Humble writes it and Jazzy reads it.
///
/// It uses a write-ahead log while recording, as rosbag2's resilient profile. Reason: rosbag2 opens
/// bags read-only. A read-only connection cannot undo the rollback journal that a kill during a
/// transaction leaves, but it reads a write-ahead log. Of 25 killed writers each, journal mode
/// DELETE left 4 readable bags, TRUNCATE 2, WAL 25. After a kill the folder has <name>_0.db3-wal
/// (and -shm) next to the .db3: keep them together, because the .db3 lacks the commits since the
/// last checkpoint (refresh). Closing merges the log and resets the journal mode, so a closed bag
/// is one file that also opens on read-only media.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "nodes/bag/bag_file.hpp"
#include "nodes/bag/refuse.hpp"
#include "nodes/bag/sqlite.hpp"

namespace voxtouch::bag {
namespace {

constexpr std::int64_t kPageBytes = 4096;

// rosbag2's schema 3 (Humble). ros_distro: the release that uses this form.
constexpr const char* kSchema = R"(
BEGIN;
CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
                    serialization_format TEXT NOT NULL,
                    offered_qos_profiles TEXT NOT NULL);
CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
                      data BLOB NOT NULL);
CREATE INDEX timestamp_idx ON messages (timestamp ASC);
INSERT INTO schema VALUES (3, 'humble');
COMMIT;
)";

class SqliteFile final : public BagFile {
 public:
  SqliteFile(std::filesystem::path path, Database database)
      : path_(std::move(path)),
        database_(std::make_unique<Database>(std::move(database))) {}

  Result<void> create_tables(std::uint64_t max_bytes) {
    auto mode = database_->value("PRAGMA journal_mode=WAL");
    if (!mode)
      return std::unexpected(mode.error());
    if (*mode != "wal")
      return refuse(
          "The file system of '{}' does not support a write-ahead log (journal mode {}). Record to "
          "a local disk.",
          path_.string(), *mode);
    // Nothing is flushed to the disk before the bag is closed: see BagWriter.
    if (auto set = database_->run("PRAGMA synchronous=OFF"); !set)
      return set;
    if (max_bytes > 0) {
      const auto pages =
          std::max<std::int64_t>(static_cast<std::int64_t>(max_bytes) / kPageBytes, 1);
      if (auto set = database_->run(fmt::format("PRAGMA max_page_count={}", pages)); !set)
        return set;
    }
    if (auto made = database_->run(kSchema); !made)
      return made;
    auto insert =
        database_->prepare("INSERT INTO messages (timestamp, topic_id, data) VALUES (?, ?, ?)");
    if (!insert)
      return std::unexpected(insert.error());
    insert_ = std::move(*insert);
    note_size();
    return {};
  }

  Result<void> add_topic(const TopicInfo& topic) override {
    auto insert = database_->prepare(
        "INSERT INTO topics (name, type, serialization_format, offered_qos_profiles) VALUES (?, ?, "
        "?, ?)");
    if (!insert)
      return std::unexpected(insert.error());
    insert->bind(1, topic.name);
    insert->bind(2, topic.type);
    insert->bind(3, topic.serialization_format);
    insert->bind(4, topic.offered_qos);
    if (insert->step() != SQLITE_DONE)
      return std::unexpected(database_->error("add a topic to"));
    rows_.push_back(database_->last_row());
    return {};
  }

  Result<void> append(TopicId topic, std::int64_t time_ns,
                      std::span<const std::byte> bytes) override {
    if (!in_transaction_) {
      if (auto begun = database_->run("BEGIN"); !begun)
        return begun;
      in_transaction_ = true;
    }
    insert_->bind(1, time_ns);
    insert_->bind(2, rows_[topic]);
    insert_->bind(3, bytes);
    const bool good = insert_->step() == SQLITE_DONE;
    std::optional<BagError> error;
    if (!good)
      error = database_->error("write to");
    insert_->reset();
    if (good)
      return {};
    if (database_->autocommit())
      in_transaction_ = false;  // sqlite undid the whole transaction
    return std::unexpected(*error);
  }

  bool pending() const noexcept override { return in_transaction_; }

  Result<void> commit() override {
    if (!in_transaction_)
      return {};
    in_transaction_ = false;
    if (auto committed = database_->run("COMMIT"); !committed) {
      BagError error = committed.error();
      if (!database_->autocommit())
        (void)database_->run("ROLLBACK");
      return std::unexpected(error);
    }
    note_size();
    return {};
  }

  Result<void> refresh(const BagMetadata& metadata) override {
    // Each step is tried whatever became of the one before.
    const auto row = write_metadata_row(metadata);
    const auto checkpoint = database_->run("PRAGMA wal_checkpoint(PASSIVE)");
    return row ? checkpoint : row;
  }

  Result<void> close(const BagMetadata& metadata, Flush flush) override {
    auto result = commit();
    const auto then = [&](const Result<void>& step) {
      if (!step && result)
        result = step;
    };
    // sqlite changes how it flushes between transactions only.
    if (flush == Flush::kYes)
      then(database_->run("PRAGMA synchronous=FULL"));
    then(refresh(metadata));
    insert_.reset();
    const auto mode = database_->value("PRAGMA journal_mode=DELETE");
    if (!mode)
      then(std::unexpected(mode.error()));
    if (mode && *mode != "delete")
      then(
          refuse("Recording '{}' is complete, but another program has it open: keep its -wal file "
                 "next to it.",
                 path_.parent_path().string()));
    database_.reset();
    return result;
  }

  std::uint64_t bytes() const noexcept override { return bytes_; }

 private:
  // The row inside the database: without it Jazzy takes the QoS texts for its newest form.
  Result<void> write_metadata_row(const BagMetadata& metadata) {
    auto insert = database_->prepare(
        "INSERT OR REPLACE INTO metadata (id, metadata_version, metadata) VALUES (1, ?2, ?1)");
    if (!insert)
      return std::unexpected(insert.error());
    insert->bind(1, metadata_yaml(metadata, false));
    insert->bind(2, std::int64_t{kMetadataVersion});
    if (insert->step() != SQLITE_DONE)
      return std::unexpected(database_->error("write the metadata of"));
    return {};
  }
  void note_size() {
    auto pages = database_->prepare("PRAGMA page_count");
    if (pages && pages->step() == SQLITE_ROW)
      bytes_ = static_cast<std::uint64_t>(pages->integer(0) * kPageBytes);
  }

  std::filesystem::path path_;
  std::unique_ptr<Database> database_;  // null once closed
  std::optional<Statement> insert_;
  std::vector<std::int64_t> rows_;  // of the topics
  bool in_transaction_ = false;
  std::uint64_t bytes_ = 0;
};

}  // namespace

Result<std::unique_ptr<BagFile>> make_sqlite_file(const std::filesystem::path& path,
                                                  std::uint64_t max_bytes) {
  auto database = Database::open(path, Database::Mode::kCreate);
  if (!database)
    return std::unexpected(database.error());
  auto file = std::make_unique<SqliteFile>(path, std::move(*database));
  if (auto made = file->create_tables(max_bytes); !made)
    return std::unexpected(made.error());
  return file;
}

}  // namespace voxtouch::bag
