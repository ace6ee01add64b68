#pragma once
/// The main function that all node programs share.
#include <atomic>
#include <functional>
#include <string>

#include "nodes/runtime/options.hpp"

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace voxtouch::runtime {

/// What kind of node a program is.
struct Program {
  std::string name;        ///< in front of what it says on stderr
  std::string about;       ///< for --help
  bool with_scene = true;  ///< takes --scene
  bool in_ring = true;     ///< asks for real-time scheduling; a tap does not
};

/// Parses `argv`, of which ROS may have written a part (ros_arguments.hpp). Throws CLI::ParseError.
void parse(CLI::App& app, int argc, char** argv);
/// What a command line that asks for help or has a fault leads to: text for a person, and the exit
/// status.
int explain(const CLI::App& app, const CLI::ParseError& error) noexcept;

/// Parses the command line (`configure` adds the node's own options), catches Ctrl-C and SIGTERM,
/// enters real time, runs. What a node throws while starting becomes a sentence on stderr and exit
/// status 1.
int node_main(int argc, char** argv, const Program& program, NodeOptions& options,
              const std::function<void(CLI::App&)>& configure,
              const std::function<int(const std::atomic<bool>& stop)>& run);

}  // namespace voxtouch::runtime
