#include "nodes/bag/sqlite.hpp"

#include <fmt/format.h>

namespace voxtouch::bag {

void Statement::bind(int index, std::int64_t value) noexcept {
  sqlite3_bind_int64(statement_.get(), index, value);
}

void Statement::bind(int index, std::string_view text) noexcept {
  sqlite3_bind_text64(statement_.get(), index, text.data(), text.size(), SQLITE_TRANSIENT,
                      SQLITE_UTF8);
}

void Statement::bind(int index, std::span<const std::byte> bytes) noexcept {
  // A null pointer would bind NULL, which the schema forbids, instead of a blob of no bytes.
  const void* data = bytes.empty() ? "" : static_cast<const void*>(bytes.data());
  sqlite3_bind_blob64(statement_.get(), index, data, bytes.size(), SQLITE_STATIC);
}

int Statement::step() noexcept { return sqlite3_step(statement_.get()); }
void Statement::reset() noexcept { sqlite3_reset(statement_.get()); }

std::int64_t Statement::integer(int column) const noexcept {
  return sqlite3_column_int64(statement_.get(), column);
}

std::string Statement::text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
  if (text == nullptr)
    return {};
  return {text, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

std::span<const std::byte> Statement::blob(int column) const noexcept {
  const auto* bytes = static_cast<const std::byte*>(sqlite3_column_blob(statement_.get(), column));
  return {bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

Result<Database> Database::open(const std::filesystem::path& file, Mode mode) {
  Database database;
  database.file_ = file;
  sqlite3* handle = nullptr;
  constexpr int kCreateFlags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  const int flags = mode == Mode::kReadOnly ? SQLITE_OPEN_READONLY : kCreateFlags;
  const int code = sqlite3_open_v2(file.c_str(), &handle, flags | SQLITE_OPEN_NOMUTEX, nullptr);
  database.handle_.reset(handle);
  if (code != SQLITE_OK)
    return std::unexpected(database.error("open"));
  sqlite3_busy_timeout(handle, 1000);
  return database;
}

Result<Statement> Database::prepare(std::string_view sql) const {
  sqlite3_stmt* raw = nullptr;
  if (sqlite3_prepare_v2(handle_.get(), sql.data(), static_cast<int>(sql.size()), &raw, nullptr) !=
      SQLITE_OK)
    return std::unexpected(error("prepare a statement for"));
  Statement statement;
  statement.statement_.reset(raw);
  return statement;
}

Result<void> Database::run(const std::string& sql) const {
  if (sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
    return std::unexpected(error("write"));
  return {};
}

Result<std::string> Database::value(std::string_view sql) const {
  auto statement = prepare(sql);
  if (!statement)
    return std::unexpected(statement.error());
  const int code = statement->step();
  if (code == SQLITE_ROW)
    return statement->text(0);
  if (code == SQLITE_DONE)
    return std::string();
  return std::unexpected(error("read"));
}

BagError Database::error(std::string_view doing) const {
  const int code = handle_ ? sqlite3_extended_errcode(handle_.get()) : SQLITE_NOMEM;
  const char* text = handle_ ? sqlite3_errmsg(handle_.get()) : "out of memory";
  std::string_view advice = "Check that the file exists and is not damaged.";
  if ((code & 0xff) == SQLITE_FULL || (code & 0xff) == SQLITE_IOERR)
    advice = "Free disk space.";
  if ((code & 0xff) == SQLITE_READONLY || (code & 0xff) == SQLITE_PERM)
    advice = "Check the permissions of the folder.";
  if ((code & 0xff) == SQLITE_BUSY)
    advice = "Close the program that uses it.";
  return {fmt::format("sqlite cannot {} '{}': {} (code {}). {}", doing, file_.string(), text, code,
                      advice)};
}

}  // namespace voxtouch::bag
