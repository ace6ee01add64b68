#pragma once
/// Restarts of nodes, and figures over all processes of a node. No side effects.
#include <string>

#include "nodes/runtime/node_registry.hpp"

namespace voxtouch::cli {

/// A node that died and was, or is to be, started again.
struct Restart {
  std::string node;
  std::string how;         ///< "signal 9", "status 1"
  double at_sample = 0.0;  ///< samples of the device until then, from its last status
  bool is_done = false;    ///< the run went on until it was started again
};

/// How a process ended, from its exit status (128 + signal number if a signal ended it): "signal
/// 9", "status 1".
std::string how_ended(int status);

/// One report for all processes of a node. Counts are summed, the first sample is that of the first
/// process, extremes are the larger ones. Of the energy accounts the worse one is kept with its
/// bound. All other values are those of `now`.
runtime::NodeReport over_all_processes(const runtime::NodeReport& earlier, runtime::NodeReport now);

}  // namespace voxtouch::cli
