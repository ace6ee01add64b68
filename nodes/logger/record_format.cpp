#include <map>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "nodes/logger/logger_node.hpp"

namespace voxtouch::logger {

void add_format_options(CLI::App& app, RecordFormat& format) {
  std::map<std::string, bag::Storage> names;
  for (const bag::StorageName& one : bag::kStorages)
    names.emplace(one.name, one.storage);
  app.add_option("--record-format", format.storage,
                 "Storage format: mcap (default; compressed, with message types) or sqlite3 (for "
                 "ROS 2 Humble)")
      ->transform(CLI::CheckedTransformer(names))
      ->option_text("mcap|sqlite3");
  app.add_option("--record-split-mb", format.split_mb,
                 "Starts a new file before one exceeds this size [MB]")
      ->check(runtime::require_positive);
  app.add_option("--record-split-s", format.split_s,
                 "Starts a new file when one covers this time [s]")
      ->check(runtime::require_positive);
}

std::vector<std::string> to_arguments(const RecordFormat& format) {
  std::vector<std::string> out;
  if (format.storage != RecordFormat{}.storage)
    out.insert(out.end(), {"--record-format", std::string(bag::names_of(format.storage).name)});
  if (format.split_mb > 0.0)
    out.insert(out.end(), {"--record-split-mb", fmt::to_string(format.split_mb)});
  if (format.split_s > 0.0)
    out.insert(out.end(), {"--record-split-s", fmt::to_string(format.split_s)});
  return out;
}

}  // namespace voxtouch::logger
