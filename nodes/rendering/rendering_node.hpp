#pragma once
/// The rendering's process: device samples in, contact out.
#include <atomic>

#include "nodes/runtime/options.hpp"

namespace voxtouch::rendering_node {

struct Options : runtime::NodeOptions {};

/// Builds the scene, then answers every device sample until `stop`. Throws while starting only.
int run(const Options& options, const std::atomic<bool>& stop);

}  // namespace voxtouch::rendering_node
