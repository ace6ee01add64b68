#include <algorithm>

#include "nodes/bag/file_reader.hpp"
#include "nodes/bag/sqlite.hpp"

namespace voxtouch::bag {
namespace {

class SqliteReader final : public FileReader {
 public:
  explicit SqliteReader(Database database) : database_(std::move(database)) {}

  Result<void> read_topics() {
    const auto has_qos = database_.value(
        "SELECT count(*) FROM pragma_table_info('topics') WHERE name='offered_qos_profiles'");
    if (!has_qos)
      return std::unexpected(has_qos.error());
    const std::string qos = *has_qos == "1" ? "offered_qos_profiles" : "''";  // schema 1 has none
    auto rows = database_.prepare("SELECT id, name, type, serialization_format, " + qos +
                                  " FROM topics ORDER BY id");
    if (!rows)
      return std::unexpected(rows.error());
    int code = rows->step();
    for (; code == SQLITE_ROW; code = rows->step()) {
      topics_.push_back({rows->text(1), rows->text(2), rows->text(3), rows->text(4), 0});
      rows_.push_back(rows->integer(0));
    }
    if (code != SQLITE_DONE)
      return std::unexpected(database_.error("read the topics of"));
    return {};
  }

  Result<bool> for_each_between(std::int64_t from_ns, std::int64_t to_ns,
                                const TakeMessage& f) const override {
    auto rows = database_.prepare(
        "SELECT topic_id, timestamp, id, data FROM messages WHERE timestamp >= ? AND timestamp < ? "
        "ORDER BY timestamp, id");
    if (!rows)
      return std::unexpected(rows.error());
    rows->bind(1, from_ns), rows->bind(2, to_ns);
    int code = rows->step();
    for (; code == SQLITE_ROW; code = rows->step()) {
      const auto row = std::ranges::find(rows_, rows->integer(0));
      if (row == rows_.end())
        continue;
      if (!f({static_cast<std::size_t>(row - rows_.begin()), rows->integer(1), rows->integer(2),
              rows->blob(3)}))
        return false;
    }
    if (code != SQLITE_DONE)
      return std::unexpected(database_.error("read the messages of"));
    return true;
  }

  Result<std::optional<std::pair<std::int64_t, std::int64_t>>> times() const override {
    // One query each: min and max then use the index only.
    auto rows = database_.prepare(
        "SELECT (SELECT min(timestamp) FROM messages), (SELECT max(timestamp) FROM messages), "
        "EXISTS (SELECT 1 FROM messages)");
    if (!rows)
      return std::unexpected(rows.error());
    if (rows->step() != SQLITE_ROW)
      return std::unexpected(database_.error("read the times of"));
    if (rows->integer(2) == 0)
      return std::nullopt;
    return std::pair{rows->integer(0), rows->integer(1)};
  }

  std::optional<std::uint64_t> message_count() const override {
    auto rows = database_.prepare("SELECT count(*) FROM messages");
    if (!rows || rows->step() != SQLITE_ROW)
      return 0;  // damaged: no message can be read
    return static_cast<std::uint64_t>(rows->integer(0));
  }

 private:
  Database database_;
  std::vector<std::int64_t> rows_;  // of the topics
};

}  // namespace

Result<std::unique_ptr<FileReader>> open_sqlite_file(const std::filesystem::path& path) {
  auto database = Database::open(path, Database::Mode::kReadOnly);
  if (!database)
    return std::unexpected(database.error());
  auto reader = std::make_unique<SqliteReader>(std::move(*database));
  if (auto read = reader->read_topics(); !read)
    return std::unexpected(read.error());
  return reader;
}

}  // namespace voxtouch::bag
