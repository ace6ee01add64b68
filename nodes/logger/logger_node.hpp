#pragma once
/// The logger's process: every topic of the ring into a rosbag2 bag, as raw CDR.
#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include "nodes/bag/bag_writer.hpp"
#include "nodes/runtime/options.hpp"

namespace voxtouch::logger {

/// How the bag is stored, and when it goes on in another file.
struct RecordFormat {
  bag::Storage storage = bag::WriterOptions{}.storage;
  double split_mb = 0.0, split_s = 0.0;  ///< of a file [10^6 bytes, s]; 0: no such bound
};
/// --record-format, --record-split-mb and --record-split-s.
void add_format_options(CLI::App& app, RecordFormat& format);
/// The words of a command line that say `format`; none where it is the default.
std::vector<std::string> to_arguments(const RecordFormat& format);

struct Options : runtime::NodeOptions {
  std::filesystem::path bag;  ///< folder to make; it must not exist
  bool bag_is_made = false;   ///< the folder is there, empty, and for this bag alone
  RecordFormat format;
  std::vector<std::string> topics;  ///< further DDS topics, "rt/..."; "rt/*" for all
};

/// Records until `stop`, then writes out what is queued. 0 if nothing was lost. Throws while
/// starting only.
int run(const Options& options, const std::atomic<bool>& stop);

}  // namespace voxtouch::logger
