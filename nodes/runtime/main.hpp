#pragma once
/// The main function of all node programs.
#include <atomic>
#include <functional>
#include <string>

#include "nodes/runtime/options.hpp"

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace voxtouch::runtime {

/// Kind and description of a node program.
struct Program {
  std::string name;        ///< prefix of its messages on stderr
  std::string about;       ///< for --help
  bool with_scene = true;  ///< has the option --scene
  bool in_ring = true;     ///< requests real-time scheduling; a tap does not
};

/// Parses `argv`, which may contain arguments of ROS (ros_arguments.hpp). Throws CLI::ParseError.
void parse(CLI::App& app, int argc, char** argv);
/// Prints the help or the parse error and returns the exit status.
int explain(const CLI::App& app, const CLI::ParseError& error) noexcept;

/// Parses the command line, catches SIGINT and SIGTERM, enables real-time scheduling and runs the
/// node. `configure` adds the node's own options. An exception during start-up is printed on
/// stderr, and the exit status is 1.
int node_main(int argc, char** argv, const Program& program, NodeOptions& options,
              const std::function<void(CLI::App&)>& configure,
              const std::function<int(const std::atomic<bool>& stop)>& run);

}  // namespace voxtouch::runtime
