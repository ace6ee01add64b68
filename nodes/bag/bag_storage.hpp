#pragma once
/// How a bag's messages are stored.
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace voxtouch::bag {

enum class Storage : std::uint8_t { kSqlite3, kMcap };

struct StorageName {
  Storage storage;
  std::string_view name;       ///< as metadata.yaml has it, and a command line
  std::string_view extension;  ///< of the files
};
inline constexpr std::array kStorages{StorageName{Storage::kSqlite3, "sqlite3", ".db3"},
                                      StorageName{Storage::kMcap, "mcap", ".mcap"}};

constexpr const StorageName& names_of(Storage storage) noexcept {
  return kStorages[static_cast<std::size_t>(storage)];
}
static_assert(names_of(Storage::kSqlite3).storage == Storage::kSqlite3 &&
              names_of(Storage::kMcap).storage == Storage::kMcap);

/// Empty for an unknown name.
constexpr std::optional<Storage> storage_named(std::string_view name) noexcept {
  for (const StorageName& one : kStorages)
    if (one.name == name)
      return one.storage;
  return std::nullopt;
}

}  // namespace voxtouch::bag
