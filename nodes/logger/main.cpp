#include <CLI/CLI.hpp>

#include "nodes/logger/logger_node.hpp"
#include "nodes/runtime/main.hpp"

namespace voxtouch::program {

int logger(int argc, char** argv) {
  voxtouch::logger::Options options;
  return voxtouch::runtime::node_main(
      argc, argv,
      {.name = "logger",
       .about =
           "voxtouch logger node: records all topics of the rig, and others by name, to a rosbag2 "
           "bag (mcap or sqlite3).\n"
           "A slow disk never slows the ring: excess messages are dropped, counted and reported.",
       .with_scene = false,
       .in_ring = false},
      options,
      [&](CLI::App& app) {
        app.add_option("--bag", options.bag, "Folder of the recording; it must not exist")
            ->required();
        app.add_flag("--bag-is-made", options.bag_is_made, "Records to an existing empty folder");
        voxtouch::logger::add_format_options(app, options.format);
        app.add_option(
               "--topic", options.topics,
               "Also records this DDS topic (of a compiled-in type), such as rt/tf; rt/* for all")
            ->check(voxtouch::runtime::check_topic);
      },
      [&](const std::atomic<bool>& stop) { return voxtouch::logger::run(options, stop); });
}

}  // namespace voxtouch::program
