#pragma once
/// sqlite3 as move-only handles that return errors.
#include <sqlite3.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "nodes/bag/error.hpp"

namespace voxtouch::bag {

/// A prepared statement. Column and parameter numbers as sqlite counts them: columns from 0,
/// parameters from 1.
class Statement {
 public:
  void bind(int index, std::int64_t value) noexcept;
  void bind(int index, std::string_view text) noexcept;  ///< copied
  /// not copied: lives until step() returns
  void bind(int index, std::span<const std::byte> bytes) noexcept;
  /// SQLITE_ROW, SQLITE_DONE or an error code.
  int step() noexcept;
  void reset() noexcept;
  std::int64_t integer(int column) const noexcept;
  std::string text(int column) const;
  /// valid until the next step() or reset()
  std::span<const std::byte> blob(int column) const noexcept;

 private:
  friend class Database;
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const noexcept { sqlite3_finalize(statement); }
  };
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

class Database {
 public:
  enum class Mode : std::uint8_t { kReadOnly, kCreate };
  /// Errors: the file is not there, may not be read or made, or is no database.
  static Result<Database> open(const std::filesystem::path& file, Mode mode);

  /// Error: sqlite does not take `sql`, or the database is damaged.
  Result<Statement> prepare(std::string_view sql) const;
  /// One or more statements without result.
  Result<void> run(const std::string& sql) const;
  /// First column of the first row as text; empty without a row.
  Result<std::string> value(std::string_view sql) const;
  /// No transaction open: sqlite undid it by itself, or none was begun.
  bool autocommit() const noexcept { return sqlite3_get_autocommit(handle_.get()) != 0; }
  std::int64_t last_row() const noexcept { return sqlite3_last_insert_rowid(handle_.get()); }
  /// The error of the last call, as a sentence about this file.
  BagError error(std::string_view doing) const;

 private:
  struct Close {
    void operator()(sqlite3* handle) const noexcept { sqlite3_close_v2(handle); }
  };
  std::filesystem::path file_;
  std::unique_ptr<sqlite3, Close> handle_;
};

}  // namespace voxtouch::bag
