#include "nodes/runtime/main.hpp"
#include "nodes/coupling/coupling_node.hpp"
#include "nodes/faults/fault_recorder.hpp"

namespace voxtouch::program {

int coupling(int argc, char** argv) {
  voxtouch::coupling_node::Options options;
  return voxtouch::runtime::node_main(
      argc, argv,
      {.name = "coupling",
       .about = "voxtouch coupling node: shapes the contact wrench for a stable loop of device, "
                "hand and contact, and commands\n"
                "the device."},
      options, [&](CLI::App& app) { voxtouch::faults::add_option(app, options.fault_records); },
      [&](const std::atomic<bool>& stop) { return voxtouch::coupling_node::run(options, stop); });
}

}  // namespace voxtouch::program
