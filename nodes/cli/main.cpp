#include <exception>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/types/version.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/log/tell.hpp"
#include "nodes/runtime/main.hpp"

namespace {

using namespace voxtouch;

/// With --json the reason is a result too, unless there is one already: stdout holds one object.
int fail(const CLI::App& verb, const std::exception& error) {
  log::tell("error: {}\n", error.what());
  const CLI::Option* const json = verb.get_option_no_throw("--json");
  if (!json || json->count() == 0 || log::has_results())
    return 1;
  try {
    const nlohmann::ordered_json result{{"ok", false}, {"problems", {error.what()}}};
    log::print_result("{}\n",
                      result.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    log::finish_results();
  } catch (const std::exception& unheard) {
    log::tell("error: {}\n", unheard.what());
  }
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  log::guard_standard_streams();
  CLI::App app(
      "voxtouch lets a person feel a mesh scene through a force-feedback device, over a ring of "
      "DDS processes.\n"
      "Try: voxtouch up deploy/scenes/cup.yaml --device sim-phantom --motion slide --duration 10");
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string(version()));
  cli::Action action;
  for (const auto add : {cli::add_up, cli::add_new, cli::add_build, cli::add_probe, cli::add_design,
                         cli::add_accuracy, cli::add_plan, cli::add_schema, cli::add_change,
                         cli::add_types, cli::add_view, cli::add_report, cli::add_replay,
                         cli::add_status, cli::add_recover, cli::add_doctor, cli::add_keys})
    add(app, action);
  try {
    runtime::parse(app, argc, argv);
  } catch (const CLI::ParseError& error) {
    return runtime::explain(app, error);
  }
  try {
    const int status = action();
    log::finish_results();
    return status;
  } catch (const std::exception& error) {
    return fail(*app.get_subcommands().front(), error);
  }
}
