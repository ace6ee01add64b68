#pragma once
/// The logger's process: every topic of the ring into a rosbag2 bag, as raw CDR.
#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include "nodes/runtime/options.hpp"

namespace voxtouch::logger {

struct Options : runtime::NodeOptions {
  std::filesystem::path bag;        ///< folder to make; it must not exist
  std::vector<std::string> topics;  ///< further DDS topics, "rt/..."; "rt/*" for all
};

/// Records until `stop`, then writes out what is queued. 0 if nothing was lost. Throws while starting only.
int run(const Options& options, const std::atomic<bool>& stop);

}  // namespace voxtouch::logger
