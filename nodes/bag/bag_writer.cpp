#include "nodes/bag/bag_writer.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "core/types/version.hpp"
#include "nodes/bag/refuse.hpp"

namespace voxtouch::bag {
namespace {

constexpr std::uint64_t kMessageOverhead =
    64;  // of a message in a file, in addition to its bytes: about

// One atomic call decides who owns the folder: of two concurrent recorders one creates it and the
// other is refused.
Result<void> make_folder(const std::filesystem::path& folder, bool is_made) {
  std::error_code error;
  if (is_made && std::filesystem::is_directory(folder, error) &&
      std::filesystem::is_empty(folder, error))
    return {};
  if (folder.has_parent_path())
    std::filesystem::create_directories(folder.parent_path(), error);
  if (error)
    return refuse("Cannot create '{}': {}. Choose another folder.", folder.parent_path().string(),
                  error.message());
  const bool made = std::filesystem::create_directory(folder, error);
  if (made)
    return {};
  if (!error || error == std::errc::file_exists)
    return refuse("'{}' exists and is not overwritten. Choose another folder or remove it.",
                  folder.string());
  return refuse("Cannot create '{}': {}. Choose another folder.", folder.string(), error.message());
}

}  // namespace

Result<BagWriter> BagWriter::create(const std::filesystem::path& folder_as_given,
                                    const WriterOptions& options) {
  // "bags/run/" and "." have no last name; the absolute, normal form has.
  std::filesystem::path folder = std::filesystem::absolute(folder_as_given).lexically_normal();
  if (!folder.has_filename())
    folder = folder.parent_path();
  if (auto made = make_folder(folder, options.folder_is_made); !made)
    return std::unexpected(made.error());
  BagWriter writer(folder, options);
  writer.metadata_.storage_identifier = names_of(options.storage).name;
  auto made = writer.open_file();
  if (made)
    made = writer.refresh();
  if (made)
    return writer;
  writer.file_.reset();
  std::error_code ignored;
  // created by this call; a partial bag would block the next recording
  std::filesystem::remove_all(folder, ignored);
  return std::unexpected(made.error());
}

BagWriter::~BagWriter() {
  if (file_)
    (void)close();
}

Result<std::unique_ptr<BagFile>> BagWriter::make_file(const std::string& name) const {
  return options_.storage == Storage::kMcap ? make_mcap_file(folder_ / name, options_.max_bytes)
                                            : make_sqlite_file(folder_ / name, options_.max_bytes);
}

Result<void> BagWriter::open_file() {
  const std::string name =
      fmt::format("{}_{}{}", folder_.filename().string(), metadata_.files.size(),
                  names_of(options_.storage).extension);
  std::error_code ignored;
  if (std::filesystem::exists(folder_ / name, ignored))  // another program's
    return refuse("'{}' exists and is not overwritten; recording continues in the current file.",
                  (folder_ / name).string());
  auto made = make_file(name);
  Result<void> result;
  if (!made)
    result = std::unexpected(made.error());
  for (std::size_t i = 0; result && i < metadata_.topics.size(); ++i)
    result = (*made)->add_topic(metadata_.topics[i]);
  // At once, not with the next refresh: a reader then finds a valid bag whenever the recorder is
  // killed.
  if (result && !metadata_.topics.empty())
    result = (*made)->refresh(metadata_);
  if (!result) {
    if (made)
      made->reset();
    std::filesystem::remove(folder_ / name, ignored);
    return result;
  }
  if (file_)
    result = file_->close(metadata_, Flush::kNo);  // a flush would delay incoming messages
  file_ = std::move(*made);
  metadata_.files.emplace_back().path = name;
  struct stat about {};
  (void)::stat((folder_ / name).c_str(), &about);
  made_.push_back({.device = about.st_dev, .inode = about.st_ino, .bytes = 0, .messages = {}});
  return result;
}

Result<TopicId> BagWriter::add_topic(const TopicInfo& topic) {
  if (!file_)
    return refuse("The bag is closed.");
  // A message that does not fit must not take its topic with it.
  if (auto committed = commit(); !committed)
    return std::unexpected(committed.error());
  if (auto added = file_->add_topic(topic); !added)
    return std::unexpected(added.error());
  topics_.emplace_back();
  metadata_.topics.push_back(topic);
  metadata_.topics.back().message_count = 0;
  return static_cast<TopicId>(topics_.size() - 1);
}

bool BagWriter::is_to_be_split(std::int64_t time_ns, std::size_t bytes) const noexcept {
  const FileInfo& file = metadata_.files.back();
  if (file.message_count + pending_.messages == 0)
    return false;  // one message is in each, however large it is
  const SplitOptions& split = options_.split;
  if (split.bytes > 0 && file_->bytes() + pending_.bytes + bytes + kMessageOverhead > split.bytes)
    return true;
  return split.time_ns > 0 && time_ns - file_begun_ns_ >= split.time_ns;
}

Result<void> BagWriter::append(TopicId id, std::int64_t time_ns, std::span<const std::byte> bytes) {
  if (!file_)
    return refuse("The bag is closed.");
  if (id >= topics_.size())
    return refuse("Topic number {} is not in the bag.", id);
  Topic& topic = topics_[id];
  if (time_ns < 0) {  // rosbag2 reads its times as unsigned and would refuse the whole bag
    ++topic.lost;
    return refuse("A message on '{}' has time {} ns; times before 1970 are not supported.",
                  metadata_.topics[id].name, time_ns);
  }
  if (metadata_.message_count + pending_.messages == 0)
    file_begun_ns_ = time_ns;
  Result<void> result;
  if (is_to_be_split(time_ns, bytes.size()) &&
      Clock::now() - last_split_refusal_ >= options_.refresh_period) {
    result = commit();
    // If no new file can be created, the current one continues and nothing is lost.
    if (auto opened = open_file(); !opened) {
      last_split_refusal_ = Clock::now();
      if (result)
        result = opened;
    } else {
      file_begun_ns_ = time_ns;
    }
    if (auto written = write_metadata(Flush::kNo); !written && result)
      result = written;
  }
  if (auto appended = file_->append(id, time_ns, bytes); !appended) {
    ++topic.lost;
    if (!file_->pending())
      drop_pending();
    return appended;
  }
  ++topic.pending;
  ++pending_.messages;
  pending_.bytes += bytes.size() + kMessageOverhead;
  pending_.first_ns = std::min(pending_.first_ns, time_ns);
  pending_.last_ns = std::max(pending_.last_ns, time_ns);
  if (file_->is_full())
    if (auto committed = commit(); !committed)
      return committed;
  return result;
}

Result<void> BagWriter::commit() {
  last_commit_ = Clock::now();
  if (!file_)
    return {};
  // Data written behind a cut restores the file's size.
  made_.back().is_cut = made_.back().is_cut || is_cut(made_.size() - 1);
  if (!file_->pending())
    return {};
  if (auto committed = file_->commit(); !committed) {
    drop_pending();
    return committed;
  }
  count_committed();
  return {};
}

void BagWriter::count_committed() {
  Made& made = made_.back();
  made.messages.resize(topics_.size());
  for (std::size_t i = 0; i < topics_.size(); ++i) {
    const std::uint64_t messages = std::exchange(topics_[i].pending, 0);
    (made.lost ? topics_[i].lost : metadata_.topics[i].message_count) += messages;
    made.messages[i] += messages;
  }
  // A database in its write-ahead log is not in its file yet.
  if (options_.storage == Storage::kMcap)
    made.bytes = file_->bytes();
  if (made.lost)
    return void(pending_ = {});
  const Extent committed{pending_.first_ns, pending_.last_ns - pending_.first_ns,
                         pending_.messages};
  metadata_.add(committed);
  metadata_.files.back().add(committed);
  pending_ = {};
}

void BagWriter::drop_pending() {
  for (auto& topic : topics_)
    topic.lost += std::exchange(topic.pending, 0);
  pending_ = {};
}

bool BagWriter::is_cut(std::size_t file) const {
  struct stat about {};
  return ::stat((folder_ / metadata_.files[file].path).c_str(), &about) == 0 &&
         static_cast<std::uint64_t>(about.st_size) < made_[file].bytes;
}

Result<void> BagWriter::check_files() {
  Result<void> result;
  for (std::size_t i = 0; i < made_.size(); ++i) {
    Made& made = made_[i];
    FileInfo& file = metadata_.files[i];
    struct stat about {};
    const bool there = ::stat((folder_ / file.path).c_str(), &about) == 0 &&
                       about.st_dev == made.device && about.st_ino == made.inode;
    if (made.lost || (there && !made.is_cut && !is_cut(i)))
      continue;
    made.lost = true;
    for (std::size_t topic = 0; topic < made.messages.size(); ++topic) {
      topics_[topic].lost += made.messages[topic];
      metadata_.topics[topic].message_count -= made.messages[topic];
    }
    metadata_.message_count -= file.message_count;
    result = refuse("'{}' was {} during recording: {} messages are lost.",
                    (folder_ / file.path).string(), there ? "cut" : "removed or replaced",
                    std::exchange(file.message_count, 0));
  }
  return result;
}

Result<void> BagWriter::write_metadata(Flush flush) const {
  return write_atomically(folder_ / "metadata.yaml", metadata_yaml(metadata_), flush);
}

Result<void> BagWriter::refresh() {
  last_refresh_ = Clock::now();
  if (!file_)
    return {};
  // Each step is tried whatever became of the one before: metadata.yaml is correct also when
  // the file is full.
  const auto committed = commit();
  const auto refreshed = file_->refresh(metadata_);
  const auto kept = check_files();
  const auto again = made_.back().lost ? open_file() : Result<void>();  // later messages are kept
  const auto yaml = write_metadata(Flush::kNo);
  for (const auto* step : {&kept, &again, &committed, &refreshed, &yaml})
    if (!*step)
      return *step;
  return {};
}

Result<void> BagWriter::tick() {
  const auto now = Clock::now();
  if (now - last_refresh_ >= options_.refresh_period)
    return refresh();
  if (now - last_commit_ >= options_.commit_period)
    return commit();
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
    if (metadata_.topics[i].type_hash.empty())
      continue;
    json["topics"][i]["type"] = metadata_.topics[i].type;
    json["topics"][i]["type_hash"] = metadata_.topics[i].type_hash;
  }
  json["errors"] = report.errors;
  return write_atomically(folder_ / "voxtouch_recording.json",
                          json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n",
                          report.closed ? Flush::kYes : Flush::kNo);
}

Result<void> BagWriter::close() {
  if (!file_)
    return {};
  // Each step is tried whatever became of the one before.
  auto result = commit();
  if (const auto kept = check_files(); !kept)
    result = kept;
  const auto closed = file_->close(metadata_, Flush::kYes);
  const auto yaml = write_metadata(Flush::kYes);
  for (const auto* step : {&closed, &yaml})
    if (!*step && result)
      result = *step;
  file_.reset();
  return result;
}

}  // namespace voxtouch::bag
