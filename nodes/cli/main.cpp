#include <exception>

#include <CLI/CLI.hpp>

#include "nodes/cli/verbs.hpp"
#include "nodes/log/tell.hpp"
#include "nodes/runtime/main.hpp"

int main(int argc, char** argv) {
  voxtouch::log::guard_standard_streams();
  CLI::App app(
      "voxtouch lets a person feel a mesh scene through a force-feedback device, over a ring of DDS processes.\n"
      "Try: voxtouch up deploy/scenes/cup.yaml --device sim-phantom --motion slide --duration 10");
  app.require_subcommand(1);
  app.set_version_flag("--version", VOXTOUCH_VERSION);
  voxtouch::cli::Action action;
  voxtouch::cli::add_up(app, action);
  voxtouch::cli::add_new(app, action);
  voxtouch::cli::add_build(app, action);
  voxtouch::cli::add_probe(app, action);
  voxtouch::cli::add_design(app, action);
  voxtouch::cli::add_accuracy(app, action);
  voxtouch::cli::add_plan(app, action);
  voxtouch::cli::add_schema(app, action);
  voxtouch::cli::add_change(app, action);
  voxtouch::cli::add_types(app, action);
  voxtouch::cli::add_view(app, action);
  voxtouch::cli::add_report(app, action);
  voxtouch::cli::add_replay(app, action);
  voxtouch::cli::add_status(app, action);
  voxtouch::cli::add_doctor(app, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return voxtouch::runtime::explain(app, error);
  }
  try {
    const int status = action();
    voxtouch::log::finish_results();
    return status;
  } catch (const std::exception& error) {
    voxtouch::log::tell("error: {}\n", error.what());
    return 1;
  }
}
