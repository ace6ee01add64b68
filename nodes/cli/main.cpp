#include <cstdio>
#include <exception>
#include <stdexcept>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "nodes/cli/verbs.hpp"

int main(int argc, char** argv) {
  CLI::App app(
      "voxtouch lets a person feel a mesh scene through a force-feedback device, over a ring of DDS processes.\n"
      "Try: voxtouch up deploy/scenes/cup.yaml --device sim-phantom --motion slide --duration 10");
  app.require_subcommand(1);
  app.set_version_flag("--version", VOXTOUCH_VERSION);
  voxtouch::cli::Action action;
  voxtouch::cli::add_up(app, action);
  voxtouch::cli::add_build(app, action);
  voxtouch::cli::add_probe(app, action);
  voxtouch::cli::add_design(app, action);
  voxtouch::cli::add_accuracy(app, action);
  voxtouch::cli::add_plan(app, action);
  voxtouch::cli::add_schema(app, action);
  voxtouch::cli::add_change(app, action);
  voxtouch::cli::add_types(app, action);
  CLI11_PARSE(app, argc, argv);
  try {
    const int status = action();
    if (std::fflush(stdout) != 0 || std::ferror(stdout))
      throw std::runtime_error("standard output could not be written: is the disk full?");
    return status;
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}
