#include <CLI/CLI.hpp>

#include "core/scene/schema.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/console/log.hpp"

namespace voxtouch::cli {

void add_schema(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand("schema");
  verb->callback([&action] {
    action = [] {
      console::print_result("{}", scene::scene_schema());
      return 0;
    };
  });
}

}  // namespace voxtouch::cli
