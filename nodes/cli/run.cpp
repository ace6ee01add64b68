#include <algorithm>
#include <exception>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/scene/map_reader.hpp"
#include "core/types/version.hpp"
#include "nodes/cli/help.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/console/log.hpp"
#include "nodes/console/reason.hpp"
#include "nodes/runtime/main.hpp"

namespace voxtouch::cli {
namespace {

/// With --json the reason is a result too, unless there is one already: stdout holds one object.
int fail(const CLI::App& app, const std::exception& error) {
  const std::string reason = console::reason_of(error);
  console::log("error: {}\n", reason);
  const CLI::App* const verb =
      app.get_subcommands().empty() ? nullptr : app.get_subcommands().front();
  const CLI::Option* const json = verb ? verb->get_option_no_throw("--json") : nullptr;
  if (!json || json->count() == 0 || console::has_results())
    return 1;
  try {
    const nlohmann::ordered_json result{{"ok", false}, {"problems", {reason}}};
    console::print_result(
        "{}\n", result.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    console::finish_results();
  } catch (const std::exception& unprinted) {
    console::log("error: {}\n", unprinted.what());
  }
  return 1;
}

void check_verb(const CLI::App& app, std::string_view verb) {
  std::vector<std::string_view> names;
  for (const CLI::App* one : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(one->get_name());
  if (!verb.starts_with('-') && std::ranges::find(names, verb) == names.end())
    throw std::invalid_argument(fmt::format("Unknown verb '{}'{} (voxtouch --help lists the verbs)",
                                            verb, scene::suggestion(verb, names)));
}

}  // namespace

int run(int argc, char** argv, std::span<AddVerb* const> verbs) {
  console::guard_standard_streams();
  CLI::App app(
      "voxtouch renders contact with a mesh scene on a force-feedback device, in a ring of DDS "
      "processes.\n"
      "Try: voxtouch up cup_virtual_tool --motion slide --view");
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string(version()));
  Action action;
  try {
    for (AddVerb* const add : verbs)
      add(app, action);
    describe_verbs(app);
    if (argc > 1)
      check_verb(app, argv[1]);
    runtime::parse(app, argc, argv);
    const int status = action();
    console::finish_results();
    return status;
  } catch (const CLI::ParseError& error) {
    return runtime::explain(app, error);
  } catch (const std::exception& error) {
    return fail(app, error);
  }
}

}  // namespace voxtouch::cli
