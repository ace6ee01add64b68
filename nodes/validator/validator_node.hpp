#pragma once
/// The validator's process: an independent reference judges every n-th contact while the verdicts
/// have a reader.
#include <atomic>
#include <cstdint>

#include "nodes/runtime/options.hpp"

namespace voxtouch::validator {

struct Options : runtime::NodeOptions {
  std::uint64_t every = 20;  ///< check samples whose sequence number is a multiple of this
};

/// Judges until `stop`, while its verdicts have a reader. Throws while starting only.
int run(const Options& options, const std::atomic<bool>& stop);

}  // namespace voxtouch::validator
