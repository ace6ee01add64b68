#pragma once
/// The coupling's process: contact in, force command out.
#include <atomic>

#include "nodes/runtime/options.hpp"

namespace voxtouch::coupling_node {

struct Options : runtime::NodeOptions {
  /// Folder for what was seen before a fault; empty: nothing is kept
  std::filesystem::path fault_records;
};

/// Answers every contact until `stop`. Throws while starting only.
int run(const Options& options, const std::atomic<bool>& stop);

}  // namespace voxtouch::coupling_node
