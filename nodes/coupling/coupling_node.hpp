#pragma once
/// The coupling process: receives contact states and publishes force commands.
#include <atomic>

#include "nodes/runtime/options.hpp"

namespace voxtouch::coupling_node {

struct Options : runtime::NodeOptions {
  /// Folder for records of faults; empty: no records.
  std::filesystem::path fault_records;
};

/// Answers every contact until `stop`. Throws only during start-up.
int run(const Options& options, const std::atomic<bool>& stop);

}  // namespace voxtouch::coupling_node
