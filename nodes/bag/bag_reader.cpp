#include "nodes/bag/bag_reader.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <system_error>

#include "nodes/bag/bag_storage.hpp"
#include "nodes/bag/refuse.hpp"

namespace voxtouch::bag {
namespace {

namespace fs = std::filesystem;

// bag_2.db3 before bag_10.db3: by length, then alphabetically, which is numerical order for names
// that differ only in the number.
std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (std::ranges::any_of(kStorages, [&](const StorageName& one) {
          return it->path().extension() == one.extension;
        }))
      found.push_back(it->path());
  std::ranges::sort(found, {}, [](const fs::path& path) {
    return std::pair(path.string().size(), path.string());
  });
  return found;
}

}  // namespace

// The parts of metadata.yaml that are needed.
struct BagReader::Described {
  std::string storage, compression;
  std::vector<std::string> files;
  std::uint64_t messages = 0;                    // of the bag
  std::map<std::string, std::uint64_t> in_file;  // from version 5 on
};

namespace {

// Empty if it is missing or invalid: the files can be read without it.
template <class Described>
std::optional<Described> read_metadata(const fs::path& file) {
  try {
    const YAML::Node node = YAML::LoadFile(file.string())["rosbag2_bagfile_information"];
    const YAML::Node mode = node["compression_mode"];
    Described out{node["storage_identifier"].as<std::string>(),
                  mode ? mode.as<std::string>() : "",
                  node["relative_file_paths"].as<std::vector<std::string>>(),
                  node["message_count"].as<std::uint64_t>(0),
                  {}};
    for (const YAML::Node& one : node["files"])
      out.in_file[one["path"].as<std::string>()] = one["message_count"].as<std::uint64_t>(0);
    return out;
  } catch (const YAML::Exception&) {
    return std::nullopt;
  }
}

// The files in the metadata, plus later ones that a killed writer did not add. If one is missing,
// the files in the folder.
std::vector<fs::path> files_of(const fs::path& folder, const std::vector<std::string>& names) {
  std::vector<fs::path> named, found = files_in(folder);
  for (const auto& file : names)
    named.push_back(folder / file);
  const bool all_there = std::ranges::all_of(named, [](const fs::path& path) {
    std::error_code error;
    return fs::exists(path, error);
  });
  if (named.empty() || !all_there)
    return found;
  const auto last = std::ranges::find(found, named.back());
  if (last != found.end())
    named.insert(named.end(), last + 1, found.end());
  return named;
}

}  // namespace

Result<BagReader> BagReader::open(const fs::path& path) {
  BagReader reader;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  std::vector<fs::path> files;
  std::optional<Described> described;
  if (fs::is_directory(status)) {
    described = read_metadata<Described>(path / "metadata.yaml");
    if (described && !described->compression.empty() && described->compression != "NONE" &&
        described->compression != "none")
      return refuse("Recording '{}' is compressed ({}). Uncompress it with `ros2 bag convert`.",
                    path.string(), described->compression);
    if (described && !described->storage.empty() && !storage_named(described->storage))
      return refuse(
          "Recording '{}' has storage format {}, supported: sqlite3 and mcap. Convert it with "
          "`ros2 bag convert`.",
          path.string(), described->storage);
    files = files_of(path, described ? described->files : std::vector<std::string>());
    if (files.empty())
      return refuse("'{}' has no .db3 and no .mcap file. Choose the folder of a recording.",
                    path.string());
  } else if (fs::is_regular_file(status)) {
    files = {path};
  } else {
    return refuse("'{}' does not exist. Choose the folder of a recording.", path.string());
  }
  for (const auto& file : files)
    if (auto added = reader.add_file(file); !added)
      return std::unexpected(added.error());
  for (const File& file : reader.files_)
    reader.message_count_ += file.reader->message_count().value_or(0);
  if (described)
    reader.compare(path, *described);
  return reader;
}

// A killed recorder leaves more messages than the metadata states. A renamed file is read.
void BagReader::compare(const fs::path& folder, const Described& metadata) {
  for (const auto& [name, stated] : metadata.in_file) {
    const auto file = std::ranges::find(files_, folder / name, &File::path);
    if (file == files_.end() && stated > 0 && message_count_ < metadata.messages)
      losses_.push_back(
          fmt::format("'{}' is missing in the recording: {} messages are lost.", name, stated));
    const auto found = file == files_.end() ? std::nullopt : file->reader->message_count();
    if (found && *found < stated)
      losses_.push_back(fmt::format("'{}' has {} of {} recorded messages; the others are lost.",
                                    name, *found, stated));
  }
  if (losses_.empty() && metadata.in_file.empty() && message_count_ < metadata.messages)
    losses_.push_back(
        fmt::format("The recording has {} of {} recorded messages; the others are lost.",
                    message_count_, metadata.messages));
}

Result<void> BagReader::add_file(const fs::path& path) {
  const bool mcap = path.extension() == names_of(Storage::kMcap).extension || is_mcap(path);
  auto opened = mcap ? open_mcap_file(path) : open_sqlite_file(path);
  if (!opened)
    return std::unexpected(opened.error());
  if (files_.empty())
    storage_ = mcap ? Storage::kMcap : Storage::kSqlite3;
  File file{std::move(*opened), {}, path};
  for (const TopicInfo& topic : file.reader->topics()) {
    auto index = find_topic(topic.name);
    if (!index) {
      index = topics_.size();
      topics_.push_back(topic);
    }
    file.topics.push_back(*index);
  }
  files_.push_back(std::move(file));
  return {};
}

std::optional<std::size_t> BagReader::find_topic(std::string_view name) const noexcept {
  const auto found = std::ranges::find(topics_, name, &TopicInfo::name);
  if (found == topics_.end())
    return std::nullopt;
  return static_cast<std::size_t>(found - topics_.begin());
}

Result<void> BagReader::for_each_between(std::int64_t from_ns, std::int64_t to_ns,
                                         const TakeMessage& f) const {
  for (const File& file : files_) {
    const auto more = file.reader->for_each_between(from_ns, to_ns, [&](const BagMessage& m) {
      return f({file.topics[m.topic], m.time_ns, m.id, m.bytes});
    });
    if (!more)
      return std::unexpected(more.error());
    if (!*more)
      return {};
  }
  return {};
}

Result<std::optional<std::pair<std::int64_t, std::int64_t>>> BagReader::times() const {
  std::optional<std::pair<std::int64_t, std::int64_t>> all;
  for (const File& file : files_) {
    const auto own = file.reader->times();
    if (!own)
      return std::unexpected(own.error());
    if (!*own)
      continue;
    all =
        all ? std::pair{std::min(all->first, (*own)->first), std::max(all->second, (*own)->second)}
            : *own;
  }
  return all;
}

}  // namespace voxtouch::bag
