#include <CLI/CLI.hpp>

#include "core/scene/schema.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/log/tell.hpp"

namespace voxtouch::cli {

void add_schema(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand(
      "schema",
      "The JSON schema (draft 2020-12) of scene files, made from the tables that the "
      "reader uses. Editors complete and check\n"
      "scenes with it: deploy/scenes/scene.schema.json is its output, and the shipped "
      "scenes name it in their first line.");
  verb->callback([&action] {
    action = [] {
      log::print_result("{}", scene::scene_schema());
      return 0;
    };
  });
}

}  // namespace voxtouch::cli
