#include "nodes/runtime/main.hpp"
#include "nodes/coupling/coupling_node.hpp"

int main(int argc, char** argv) {
  voxtouch::coupling_node::Options options;
  return voxtouch::runtime::node_main(
      argc, argv,
      {.name = "coupling",
       .about = "voxtouch coupling node: shapes the contact wrench so that device, hand and contact stay stable "
                "together, and commands the\n"
                "device."},
      options, [](CLI::App&) {}, [&](const std::atomic<bool>& stop) { return voxtouch::coupling_node::run(options, stop); });
}
