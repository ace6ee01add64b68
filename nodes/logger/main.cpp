#include <CLI/CLI.hpp>

#include "nodes/logger/logger_node.hpp"
#include "nodes/runtime/main.hpp"

namespace voxtouch::program {

int logger(int argc, char** argv) {
  voxtouch::logger::Options options;
  return voxtouch::runtime::node_main(
      argc, argv,
      {.name = "logger",
       .about = "voxtouch logger node: records every topic of the rig, and others by name, into a "
                "rosbag2 bag "
                "(sqlite3 or mcap), message by\n"
                "message as it came. A slow disk never slows the ring: what does not fit is "
                "dropped, counted and said.",
       .with_scene = false,
       .in_ring = false},
      options,
      [&](CLI::App& app) {
        app.add_option("--bag", options.bag, "Folder of the bag; it must not exist")->required();
        app.add_flag("--bag-is-made", options.bag_is_made,
                     "The folder exists, is empty and is meant for this bag alone");
        voxtouch::logger::add_format_options(app, options.format);
        app.add_option(
               "--topic", options.topics,
               "A further DDS topic of a type that is compiled in, such as rt/tf; rt/* for all")
            ->check(voxtouch::runtime::check_topic);
      },
      [&](const std::atomic<bool>& stop) { return voxtouch::logger::run(options, stop); });
}

}  // namespace voxtouch::program
