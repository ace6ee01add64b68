#include "nodes/runtime/main.hpp"

#include <cstdio>
#include <exception>

#include <fmt/format.h>

#include "nodes/runtime/signals.hpp"

namespace voxtouch::runtime {

int node_main(int argc, char** argv, const std::string& about, NodeOptions& options, bool with_scene,
              const std::function<void(CLI::App&)>& configure, const std::function<int(const std::atomic<bool>& stop)>& run) {
  CLI::App app(about);
  add_node_options(app, options, with_scene);
  bool child = false;
  app.add_flag("--with-parent", child, "Stop when the parent process dies (voxtouch up sets this)");
  configure(app);
  CLI11_PARSE(app, argc, argv);
  if (child) die_with_parent();
  catch_signals();
  try {
    for (const std::string& warning : enter_realtime(options.realtime)) fmt::print(stderr, "warning: {}\n", warning);
    return run(stop_requested());
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}

}  // namespace voxtouch::runtime
