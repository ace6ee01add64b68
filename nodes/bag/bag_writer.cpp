#include "nodes/bag/bag_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>

#include "core/types/version.hpp"
#include "nodes/bag/refuse.hpp"

namespace voxtouch::bag {
namespace {

constexpr std::int64_t kPageBytes = 4096;

// rosbag2's schema 3 (Humble). ros_distro: the release whose form this is.
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

// One call decides who owns the folder: of two recorders that race for it one makes it and the other is
// refused.
Result<void> make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  if (folder.has_parent_path()) std::filesystem::create_directories(folder.parent_path(), error);
  if (error)
    return refuse("'{}' cannot be made: {}. Choose another folder.", folder.parent_path().string(),
                  error.message());
  const bool made = std::filesystem::create_directory(folder, error);
  if (made) return {};
  if (!error || error == std::errc::file_exists)
    return refuse("'{}' exists already and a bag is never written over another one. Choose another folder or "
                  "remove it.",
                  folder.string());
  return refuse("'{}' cannot be made: {}. Choose another folder.", folder.string(), error.message());
}

}  // namespace

Result<BagWriter> BagWriter::create(const std::filesystem::path& folder_as_given, const WriterOptions& options) {
  // "bags/run/" and "." have no last name; the absolute, normal form has.
  std::filesystem::path folder = std::filesystem::absolute(folder_as_given).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  if (auto made = make_folder(folder); !made) return std::unexpected(made.error());
  const std::string file = folder.filename().string() + "_0.db3";
  auto database = Database::open(folder / file, Database::Mode::kCreate);
  if (!database) return std::unexpected(database.error());
  BagWriter writer(folder, options, std::move(*database));
  writer.metadata_.files = {file};
  auto made = writer.create_tables();
  if (made) made = writer.refresh();
  if (made) return writer;
  writer.insert_.reset();
  writer.database_.reset();
  std::error_code ignored;
  // made above by this call; half a bag would only stand in the next one's way
  std::filesystem::remove_all(folder, ignored);
  return std::unexpected(made.error());
}

BagWriter::BagWriter(std::filesystem::path folder, const WriterOptions& options, Database database)
    : folder_(std::move(folder)), options_(options), database_(std::make_unique<Database>(std::move(database))),
      last_commit_(Clock::now()), last_refresh_(Clock::now()) {}

BagWriter::~BagWriter() {
  if (database_) (void)close();
}

Result<void> BagWriter::create_tables() {
  auto mode = database_->value("PRAGMA journal_mode=WAL");
  if (!mode) return std::unexpected(mode.error());
  if (*mode != "wal")
    return refuse("The file system of '{}' cannot share a write-ahead log (journal mode stays {}). Record to "
                  "a local disk.",
                  folder_.string(), *mode);
  if (auto set = database_->run("PRAGMA synchronous=OFF"); !set) return set;
  if (options_.max_bytes > 0) {
    const auto pages = std::max<std::int64_t>(static_cast<std::int64_t>(options_.max_bytes) / kPageBytes, 1);
    if (auto set = database_->run(fmt::format("PRAGMA max_page_count={}", pages)); !set) return set;
  }
  if (auto made = database_->run(kSchema); !made) return made;
  auto insert = database_->prepare("INSERT INTO messages (timestamp, topic_id, data) VALUES (?, ?, ?)");
  if (!insert) return std::unexpected(insert.error());
  insert_ = std::move(*insert);
  return {};
}

Result<TopicId> BagWriter::add_topic(const TopicInfo& topic) {
  if (!database_) return refuse("The bag is closed.");
  // Out of the open transaction: a message that does not fit must not take its topic with it.
  if (auto committed = commit(); !committed) return std::unexpected(committed.error());
  auto insert = database_->prepare(
      "INSERT INTO topics (name, type, serialization_format, offered_qos_profiles) VALUES (?, ?, ?, ?)");
  if (!insert) return std::unexpected(insert.error());
  insert->bind(1, topic.name);
  insert->bind(2, topic.type);
  insert->bind(3, topic.serialization_format);
  insert->bind(4, topic.offered_qos);
  if (insert->step() != SQLITE_DONE) return std::unexpected(database_->error("add a topic to"));
  topics_.push_back({.row = database_->last_row()});
  metadata_.topics.push_back(topic);
  metadata_.topics.back().message_count = 0;
  return static_cast<TopicId>(topics_.size() - 1);
}

Result<void> BagWriter::begin() {
  if (in_transaction_) return {};
  if (auto begun = database_->run("BEGIN"); !begun) return begun;
  in_transaction_ = true;
  return {};
}

Result<void> BagWriter::append(TopicId id, std::int64_t time_ns, std::span<const std::byte> bytes) {
  if (!database_) return refuse("The bag is closed.");
  if (id >= topics_.size()) return refuse("Topic number {} was never added to the bag.", id);
  Topic& topic = topics_[id];
  if (time_ns < 0) {  // rosbag2 reads its times as unsigned and would refuse the whole bag
    ++topic.lost;
    return refuse("A message on '{}' has the time {} ns; a bag holds none before 1970.",
                  metadata_.topics[id].name, time_ns);
  }
  if (auto begun = begin(); !begun) {
    ++topic.lost;
    return begun;
  }
  insert_->bind(1, time_ns);
  insert_->bind(2, topic.row);
  insert_->bind(3, bytes);
  const bool good = insert_->step() == SQLITE_DONE;
  std::optional<BagError> error;
  if (!good) error = database_->error("write to");
  insert_->reset();
  if (!good) {
    ++topic.lost;
    if (database_->autocommit()) lose_pending();  // sqlite undid the whole transaction
    return std::unexpected(*error);
  }
  ++topic.pending;
  ++pending_.messages;
  pending_.first_ns = std::min(pending_.first_ns, time_ns);
  pending_.last_ns = std::max(pending_.last_ns, time_ns);
  return {};
}

Result<void> BagWriter::commit() {
  last_commit_ = Clock::now();
  if (!database_ || !in_transaction_) return {};
  if (auto committed = database_->run("COMMIT"); !committed) {
    BagError error = committed.error();
    if (!database_->autocommit()) (void)database_->run("ROLLBACK");
    lose_pending();
    return std::unexpected(error);
  }
  commit_counts();
  return {};
}

void BagWriter::commit_counts() {
  for (std::size_t i = 0; i < topics_.size(); ++i)
    metadata_.topics[i].message_count += std::exchange(topics_[i].pending, 0);
  if (pending_.messages > 0) {
    const bool first = metadata_.message_count == 0;
    const std::int64_t first_ns = metadata_.starting_time_ns, last_ns = first_ns + metadata_.duration_ns;
    const std::int64_t begin = first ? pending_.first_ns : std::min(first_ns, pending_.first_ns);
    const std::int64_t end = first ? pending_.last_ns : std::max(last_ns, pending_.last_ns);
    metadata_.starting_time_ns = begin;
    metadata_.duration_ns = end - begin;
    metadata_.message_count += pending_.messages;
  }
  pending_ = {};
  in_transaction_ = false;
}

void BagWriter::lose_pending() {
  for (auto& topic : topics_) topic.lost += std::exchange(topic.pending, 0);
  pending_ = {};
  in_transaction_ = false;
}

Result<void> BagWriter::write_metadata_row() {
  auto insert = database_->prepare("INSERT OR REPLACE INTO metadata (id, metadata_version, metadata) VALUES (1, 5, ?)");
  if (!insert) return std::unexpected(insert.error());
  insert->bind(1, metadata_yaml(metadata_, false));
  if (insert->step() != SQLITE_DONE) return std::unexpected(database_->error("write the metadata of"));
  return {};
}

Result<void> BagWriter::refresh() { return refresh(Flush::kNo); }

Result<void> BagWriter::refresh(Flush flush) {
  last_refresh_ = Clock::now();
  if (!database_) return {};
  // Each step is tried whatever became of the one before: metadata.yaml tells the truth also when the
  // database is full.
  const auto committed = commit();
  const auto row = write_metadata_row();
  const auto checkpoint = database_->run("PRAGMA wal_checkpoint(PASSIVE)");
  const auto yaml = write_atomically(folder_ / "metadata.yaml", metadata_yaml(metadata_), flush);
  for (const auto* step : {&committed, &row, &checkpoint, &yaml})
    if (!*step) return *step;
  return {};
}

Result<void> BagWriter::tick() {
  const auto now = Clock::now();
  if (now - last_refresh_ >= options_.refresh_period) return refresh();
  if (now - last_commit_ >= options_.commit_period) return commit();
  return {};
}

void BagWriter::fill_counts(std::vector<TopicReport>& topics) const {
  for (std::size_t i = 0; i < topics_.size() && i < topics.size(); ++i) {
    topics[i].written = metadata_.topics[i].message_count;
    topics[i].lost = topics_[i].lost;
  }
}

Result<void> BagWriter::report(const RecordingReport& report) {
  nlohmann::ordered_json json;
  json["version"] = 1;
  json["voxtouch"] = version();
  json["closed"] = report.closed;
  json["lockstep"] = report.lockstep;
  json["topics"] = nlohmann::ordered_json::array();
  for (const auto& topic : report.topics)
    json["topics"].push_back({{"name", topic.name},
                              {"received", topic.received},
                              {"written", topic.written},
                              {"dropped", topic.dropped},
                              {"lost", topic.lost}});
  for (std::size_t i = 0; i < metadata_.topics.size() && i < json["topics"].size(); ++i) {
    if (metadata_.topics[i].type_hash.empty()) continue;
    json["topics"][i]["type"] = metadata_.topics[i].type;
    json["topics"][i]["type_hash"] = metadata_.topics[i].type_hash;
  }
  json["errors"] = report.errors;
  return write_atomically(folder_ / "voxtouch_recording.json",
                          json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n",
                          report.closed ? Flush::kYes : Flush::kNo);
}

Result<void> BagWriter::close() {
  if (!database_) return {};
  // sqlite changes how it flushes between transactions only. Each step is tried whatever became of the one before.
  auto result = commit();
  for (const auto& step : {database_->run("PRAGMA synchronous=FULL"), refresh(Flush::kYes)})
    if (!step && result) result = step;
  insert_.reset();
  const auto mode = database_->value("PRAGMA journal_mode=DELETE");
  if (!mode && result) result = std::unexpected(mode.error());
  if (mode && *mode != "delete" && result)
    result = refuse("The bag '{}' is complete, but another program has it open, so its -wal file stays; keep "
                    "the two together.",
                    folder_.string());
  database_.reset();
  return result;
}

}  // namespace voxtouch::bag
