#include "nodes/runtime/main.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <sstream>

#include <CLI/CLI.hpp>

#include "core/types/version.hpp"
#include "nodes/console/log.hpp"
#include "nodes/console/reason.hpp"
#include "nodes/runtime/help_layout.hpp"
#include "nodes/runtime/ros_arguments.hpp"
#include "nodes/runtime/signals.hpp"

namespace voxtouch::runtime {
namespace {

/// Retired options and their replacements.
struct Renamed {
  std::string_view old_name, name;
};
constexpr std::array kRenamed{Renamed{"--beside", "--compare-with"},
                              Renamed{"--damper-share", "--damping-force-ratio"},
                              Renamed{"--damping-floor", "--min-damping-ratio"},
                              Renamed{"--grip-harder-at", "--grip-change-time"},
                              Renamed{"--held", "--gripped"},
                              Renamed{"--let-go-at", "--release-time"}};

}  // namespace

void parse(CLI::App& app, int argc, char** argv) {
  for (int n = 1; n < argc; ++n)
    for (const auto& [old_name, name] : kRenamed) {
      const std::string_view word = argv[n];
      if (word == old_name || (word.starts_with(old_name) && word[old_name.size()] == '='))
        throw CLI::ExtrasError(app.get_name(), std::vector{std::string(old_name) +
                                                           "; its name is " + std::string(name)});
    }
  std::vector<std::string> words = without_ros_arguments(argc, argv);
  std::ranges::reverse(words);  // in the order that CLI11 expects
  app.name(argc > 0 ? argv[0] : "");
  wrap_help(app);
  app.parse(std::move(words));
}

int explain(const CLI::App& app, const CLI::ParseError& error) noexcept {
  try {
    std::ostringstream out, err;
    const int status = app.exit(error, out, err);
    console::log("{}", err.str());
    console::print_result("{}", out.str());
    console::finish_results();
    return status;
  } catch (const std::exception& failure) {
    console::log("error: {}\n", failure.what());
    return 1;
  }
}

int node_main(int argc, char** argv, const Program& program, NodeOptions& options,
              const std::function<void(CLI::App&)>& configure,
              const std::function<int(const std::atomic<bool>& stop)>& run) {
  CLI::App app(program.about);
  console::guard_standard_streams();
  try {
    add_node_options(app, options, program.with_scene);
    app.set_version_flag("--version", std::string(version()));
    int parent = 0;
    app.add_option("--with-parent", parent,
                   "Stops when this parent process ends (set by voxtouch up)");
    configure(app);
    parse(app, argc, argv);
    catch_signals();
    if (parent)
      die_with_parent(parent);
    options.announce = parent == 0;
    options.rig_is_checked = parent != 0;
    options.require_keys(program.name);  // fails first, without any start-up work
    if (!program.in_ring)
      options.realtime.mode = Realtime::kOff;
    options.warnings = enter_realtime(options.scheduling());
    for (const std::string& warning :
         options.announce ? options.warnings : std::vector<std::string>())
      console::log("warning: {}: {}\n", program.name, warning);
    return run(stop_requested());
  } catch (const CLI::ParseError& error) {
    return explain(app, error);
  } catch (const std::exception& error) {
    console::log("error: {}: {}\n", program.name, console::reason_of(error));
    return 1;
  }
}

}  // namespace voxtouch::runtime
