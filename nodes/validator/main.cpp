#include <CLI/CLI.hpp>

#include "nodes/runtime/main.hpp"
#include "nodes/validator/validator_node.hpp"

namespace voxtouch::program {

int validator(int argc, char** argv) {
  voxtouch::validator::Options options;
  return voxtouch::runtime::node_main(
      argc, argv,
      {.name = "validator",
       .about = "voxtouch validator node: checks every n-th contact against exact distances (FCL "
                "and closed forms), independent of the\n"
                "rendering's code, and reports the cause of each disagreement.",
       .in_ring = false},
      options,
      [&](CLI::App& app) {
        app.add_option("--every", options.every,
                       "Checks samples whose sequence number is a multiple of this")
            ->capture_default_str()
            ->check(voxtouch::runtime::require_count);
      },
      [&](const std::atomic<bool>& stop) { return voxtouch::validator::run(options, stop); });
}

}  // namespace voxtouch::program
