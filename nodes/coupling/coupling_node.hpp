#pragma once
/// The coupling's process: contact in, force command out.
#include <atomic>

#include "nodes/runtime/options.hpp"
#include "nodes/runtime/standby_options.hpp"

namespace voxtouch::coupling_node {

struct Options : runtime::NodeOptions {
  runtime::StandbyOptions standby;
  std::filesystem::path
      fault_records;  ///< folder for what was seen before a fault; empty: nothing is kept
};

/// Answers every contact until `stop`. Throws while starting only.
int run(const Options& options, const std::atomic<bool>& stop);

}  // namespace voxtouch::coupling_node
