#include "nodes/bag/bag_reader.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <system_error>

#include "nodes/bag/refuse.hpp"

namespace voxtouch::bag {
namespace {

namespace fs = std::filesystem;

// bag_2.db3 before bag_10.db3: by length, then by letters, which is by number where the names differ in the
// number only.
std::vector<fs::path> databases_in(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == ".db3") found.push_back(it->path());
  std::ranges::sort(found, {}, [](const fs::path& path) { return std::pair(path.string().size(), path.string()); });
  return found;
}

// What of a folder's metadata.yaml is needed.
struct Described {
  std::string storage, compression;
  std::vector<std::string> files;
};

// Nothing where it is missing or no metadata of a bag: the databases can be read without it.
std::optional<Described> read_metadata(const fs::path& file) {
  try {
    const YAML::Node node = YAML::LoadFile(file.string())["rosbag2_bagfile_information"];
    const YAML::Node mode = node["compression_mode"];
    return Described{node["storage_identifier"].as<std::string>(), mode ? mode.as<std::string>() : "",
                     node["relative_file_paths"].as<std::vector<std::string>>()};
  } catch (const YAML::Exception&) {
    return std::nullopt;
  }
}

// The files that metadata names; if one is not there, what the folder holds.
std::vector<fs::path> databases_of(const fs::path& folder, const std::optional<Described>& metadata) {
  std::vector<fs::path> named;
  if (metadata)
    for (const auto& file : metadata->files) named.push_back(folder / file);
  const bool all_there = std::ranges::all_of(named, [](const fs::path& path) {
    std::error_code error;
    return fs::exists(path, error);
  });
  return !named.empty() && all_there ? named : databases_in(folder);
}

}  // namespace

Result<BagReader> BagReader::open(const fs::path& path) {
  BagReader reader;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  std::vector<fs::path> files;
  if (fs::is_directory(status)) {
    const std::optional<Described> described = read_metadata(path / "metadata.yaml");
    if (described && !described->compression.empty() && described->compression != "NONE" && described->compression != "none")
      return refuse("The bag '{}' is compressed ({}). Uncompress it with ros2 bag convert.", path.string(), described->compression);
    if (described && described->storage != "sqlite3")
      return refuse("The bag '{}' is stored as {}, and only sqlite3 is read. Convert it with ros2 bag convert.", path.string(),
                    described->storage);
    files = databases_of(path, described);
    if (files.empty())
      return refuse("'{}' holds no .db3 file. Name a folder that holds a bag.", path.string());
  } else if (fs::is_regular_file(status)) {
    files = {path};
  } else {
    return refuse("'{}' is not there. Name a folder that holds a bag.", path.string());
  }
  for (const auto& file : files)
    if (auto added = reader.add_file(file); !added) return std::unexpected(added.error());
  return reader;
}

Result<void> BagReader::add_file(const fs::path& path) {
  auto opened = Database::open(path, Database::Mode::kReadOnly);
  if (!opened) return std::unexpected(opened.error());
  File file{std::move(*opened), {}};
  const auto has_qos =
      file.database.value("SELECT count(*) FROM pragma_table_info('topics') WHERE name='offered_qos_profiles'");
  if (!has_qos) return std::unexpected(has_qos.error());
  const std::string qos = *has_qos == "1" ? "offered_qos_profiles" : "''";  // schema 1 has none
  auto rows = file.database.prepare("SELECT id, name, type, serialization_format, " + qos + " FROM topics ORDER BY id");
  if (!rows) return std::unexpected(rows.error());
  int code = rows->step();
  for (; code == SQLITE_ROW; code = rows->step()) {
    auto index = find_topic(rows->text(1));
    if (!index) {
      index = topics_.size();
      topics_.push_back({rows->text(1), rows->text(2), rows->text(3), rows->text(4), 0});
    }
    file.topics.emplace_back(rows->integer(0), *index);
  }
  if (code != SQLITE_DONE) return std::unexpected(file.database.error("read the topics of"));
  files_.push_back(std::move(file));
  return {};
}

std::optional<std::size_t> BagReader::File::index_of(std::int64_t row) const noexcept {
  const auto found = std::ranges::find(topics, row, &std::pair<std::int64_t, std::size_t>::first);
  if (found == topics.end()) return std::nullopt;
  return found->second;
}

std::optional<std::size_t> BagReader::find_topic(std::string_view name) const noexcept {
  const auto found = std::ranges::find(topics_, name, &TopicInfo::name);
  if (found == topics_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - topics_.begin());
}

/// Gives the rows of a statement to f; false where f wanted no more.
Result<bool> BagReader::hand_out(const File& file, Statement& rows, const std::function<bool(const BagMessage&)>& f) const {
  int code = rows.step();
  for (; code == SQLITE_ROW; code = rows.step())
    if (const auto index = file.index_of(rows.integer(0)))
      if (!f({*index, rows.integer(1), rows.integer(2), rows.blob(3)})) return false;
  if (code != SQLITE_DONE) return std::unexpected(file.database.error("read the messages of"));
  return true;
}

Result<void> BagReader::for_each_between(std::int64_t from_ns, std::int64_t to_ns,
                                         const std::function<bool(const BagMessage&)>& f) const {
  for (const auto& file : files_) {
    auto rows = file.database.prepare(
        "SELECT topic_id, timestamp, id, data FROM messages WHERE timestamp >= ? AND timestamp < ? ORDER BY timestamp, id");
    if (!rows) return std::unexpected(rows.error());
    rows->bind(1, from_ns), rows->bind(2, to_ns);
    const auto more = hand_out(file, *rows, f);
    if (!more) return std::unexpected(more.error());
    if (!*more) return {};
  }
  return {};
}

Result<std::optional<std::pair<std::int64_t, std::int64_t>>> BagReader::times() const {
  std::optional<std::pair<std::int64_t, std::int64_t>> all;
  for (const auto& file : files_) {
    // One at a time: only then the index alone is looked at.
    auto rows = file.database.prepare(
        "SELECT (SELECT min(timestamp) FROM messages), (SELECT max(timestamp) FROM messages), EXISTS (SELECT 1 FROM messages)");
    if (!rows) return std::unexpected(rows.error());
    if (rows->step() != SQLITE_ROW) return std::unexpected(file.database.error("read the times of"));
    if (rows->integer(2) == 0) continue;
    const std::pair own{rows->integer(0), rows->integer(1)};
    all = all ? std::pair{std::min(all->first, own.first), std::max(all->second, own.second)} : own;
  }
  return all;
}

}  // namespace voxtouch::bag
