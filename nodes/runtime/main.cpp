#include "nodes/runtime/main.hpp"

#include <cstdio>
#include <exception>

#include <fmt/format.h>

#include "nodes/runtime/signals.hpp"

namespace voxtouch::runtime {

int node_main(int argc, char** argv, const Program& program, NodeOptions& options,
              const std::function<void(CLI::App&)>& configure,
              const std::function<int(const std::atomic<bool>& stop)>& run) {
  CLI::App app(program.about);
  add_node_options(app, options, program.with_scene);
  int parent = 0;
  app.add_option("--with-parent", parent, "Stop when this parent process dies (voxtouch up sets this)");
  configure(app);
  CLI11_PARSE(app, argc, argv);
  catch_signals();
  if (parent) die_with_parent(parent);
  options.announce = parent == 0;
  try {
    if (!program.in_ring) options.realtime.mode = Realtime::kOff;
    options.warnings = enter_realtime(options.realtime);
    for (const std::string& warning : options.warnings) fmt::print(stderr, "warning: {}: {}\n", program.name, warning);
    return run(stop_requested());
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}: {}\n", program.name, error.what());
    return 1;
  }
}

}  // namespace voxtouch::runtime
