#pragma once
/// The logger process: records every topic of the ring as raw CDR into a rosbag2 bag.
#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include "nodes/bag/bag_writer.hpp"
#include "nodes/runtime/options.hpp"

namespace voxtouch::logger {

/// Storage format of the bag and the limits of its files.
struct RecordFormat {
  bag::Storage storage = bag::WriterOptions{}.storage;
  double split_mb = 0.0, split_s = 0.0;  ///< of a file [10^6 bytes, s]; 0: no limit
};
/// Adds --record-format, --record-split-mb and --record-split-s.
void add_format_options(CLI::App& app, RecordFormat& format);
/// The command-line arguments that give `format`; empty for the default.
std::vector<std::string> to_arguments(const RecordFormat& format);

struct Options : runtime::NodeOptions {
  std::filesystem::path bag;  ///< folder to create; it must not exist
  bool bag_is_made = false;   ///< the folder exists, is empty and is reserved for this bag
  RecordFormat format;
  std::vector<std::string> topics;  ///< additional DDS topics, "rt/..."; "rt/*" for all
};

/// Records until `stop`, then writes the queued messages. Returns 0 if no message was lost. Throws
/// only during start-up.
int run(const Options& options, const std::atomic<bool>& stop);

}  // namespace voxtouch::logger
