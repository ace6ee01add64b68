#pragma once
/// The validator: an independent reference evaluates every n-th contact while the verdicts have a
/// reader.
#include <atomic>
#include <cstdint>

#include "nodes/runtime/options.hpp"

namespace voxtouch::validator {

struct Options : runtime::NodeOptions {
  std::uint64_t every = 20;  ///< check samples whose sequence number is a multiple of this
};

/// Runs until `stop`. Throws while starting only.
int run(const Options& options, const std::atomic<bool>& stop);

}  // namespace voxtouch::validator
