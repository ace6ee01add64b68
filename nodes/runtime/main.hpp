#pragma once
/// The main function that all node programs share.
#include <atomic>
#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include "nodes/runtime/options.hpp"

namespace voxtouch::runtime {

/// Parses the command line (`configure` adds the node's own options), catches Ctrl-C and SIGTERM, enters real time, runs. What a
/// node throws while starting becomes a sentence on stderr and exit status 1.
int node_main(int argc, char** argv, const std::string& about, NodeOptions& options, bool with_scene,
              const std::function<void(CLI::App&)>& configure, const std::function<int(const std::atomic<bool>& stop)>& run);

}  // namespace voxtouch::runtime
