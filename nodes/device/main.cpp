#include "nodes/runtime/main.hpp"
#include "nodes/device/device_node.hpp"

namespace voxtouch::program {

int device(int argc, char** argv) {
  voxtouch::device_node::Options options;
  return voxtouch::runtime::node_main(
      argc, argv,
      {.name = "device",
       .about = "voxtouch device node: reads a haptic device (or simulates a device and hand), "
                "publishes its state and commands\n"
                "forces through the force guard. It ends with the device at zero force."},
      options, [&](CLI::App& app) { voxtouch::device_node::add_device_options(app, options); },
      [&](const std::atomic<bool>& stop) { return voxtouch::device_node::run(options, stop); });
}

}  // namespace voxtouch::program
