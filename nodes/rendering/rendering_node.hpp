#pragma once
/// The rendering process: receives device samples and publishes contact states.
#include <atomic>

#include "nodes/runtime/options.hpp"

namespace voxtouch::rendering_node {

struct Options : runtime::NodeOptions {};

/// Builds the scene, then answers every device sample until `stop`. Throws only during start-up.
int run(const Options& options, const std::atomic<bool>& stop);

}  // namespace voxtouch::rendering_node
