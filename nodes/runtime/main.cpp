#include "nodes/runtime/main.hpp"

#include <algorithm>
#include <exception>
#include <sstream>

#include <CLI/CLI.hpp>

#include "core/types/version.hpp"
#include "nodes/log/reason.hpp"
#include "nodes/log/tell.hpp"
#include "nodes/runtime/ros_arguments.hpp"
#include "nodes/runtime/signals.hpp"

namespace voxtouch::runtime {

void parse(CLI::App& app, int argc, char** argv) {
  std::vector<std::string> words = without_ros_arguments(argc, argv);
  std::ranges::reverse(words);  // as CLI11 takes them
  app.name(argc > 0 ? argv[0] : "");
  app.parse(std::move(words));
}

int explain(const CLI::App& app, const CLI::ParseError& error) noexcept {
  try {
    std::ostringstream out, err;
    const int status = app.exit(error, out, err);
    log::tell("{}", err.str());
    log::print_result("{}", out.str());
    log::finish_results();
    return status;
  } catch (const std::exception& failure) {
    log::tell("error: {}\n", failure.what());
    return 1;
  }
}

int node_main(int argc, char** argv, const Program& program, NodeOptions& options,
              const std::function<void(CLI::App&)>& configure,
              const std::function<int(const std::atomic<bool>& stop)>& run) {
  CLI::App app(program.about);
  log::guard_standard_streams();
  try {
    add_node_options(app, options, program.with_scene);
    app.set_version_flag("--version", std::string(version()));
    int parent = 0;
    app.add_option("--with-parent", parent,
                   "Stop when this parent process dies (voxtouch up sets this)");
    configure(app);
    parse(app, argc, argv);
    catch_signals();
    if (parent)
      die_with_parent(parent);
    options.announce = parent == 0;
    options.rig_is_checked = parent != 0;
    options.require_keys(program.name);  // before anything starts
    if (!program.in_ring)
      options.realtime.mode = Realtime::kOff;
    options.warnings = enter_realtime(options.scheduling());
    for (const std::string& warning :
         options.announce ? options.warnings : std::vector<std::string>())
      log::tell("warning: {}: {}\n", program.name, warning);
    return run(stop_requested());
  } catch (const CLI::ParseError& error) {
    return explain(app, error);
  } catch (const std::exception& error) {
    log::tell("error: {}: {}\n", program.name, log::reason_of(error));
    return 1;
  }
}

}  // namespace voxtouch::runtime
