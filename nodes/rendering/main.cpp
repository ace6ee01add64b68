#include "nodes/runtime/main.hpp"
#include "nodes/rendering/rendering_node.hpp"

namespace voxtouch::program {

int rendering(int argc, char** argv) {
  voxtouch::rendering_node::Options options;
  return voxtouch::runtime::node_main(
      argc, argv,
      {.name = "rendering",
       .about = "voxtouch rendering node: builds the scene's voxmap and pointshell and computes "
                "the contact wrench of each device sample."},
      options, [](CLI::App&) {},
      [&](const std::atomic<bool>& stop) { return voxtouch::rendering_node::run(options, stop); });
}

}  // namespace voxtouch::program
