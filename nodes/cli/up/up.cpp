#include <algorithm>
#include <csignal>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "core/scene/scene_file.hpp"
#include "devices/settings.hpp"
#include "nodes/cli/up/next_run.hpp"
#include "nodes/cli/up/ring_run.hpp"
#include "nodes/cli/up/run_files.hpp"
#include "nodes/cli/up/start_report.hpp"
#include "nodes/cli/up/up_checks.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/console/log.hpp"
#include "nodes/runtime/scene_argument.hpp"
#include "nodes/runtime/signals.hpp"

namespace voxtouch::cli {
namespace {

/// Checks the keys of all processes at once; otherwise the nodes would fail one by one.
void require_all_keys(const UpOptions& options) {
  if (!options.node.security.empty() && options.ring.one_process)
    throw std::runtime_error(
        "--security needs one process per node (Cyclone DDS 0.10 has one certificate a process). "
        "Start without --one-process");
  for (const std::string& role : security::roles())
    if ((role != "logger" || !options.no_record) && (role != security::kTool || options.view))
      options.node.require_keys(role);
}

/// Only a process can be restarted, while the device continues.
void check_restarts(const UpOptions& options) {
  if (options.restarts == 0)
    return;
  if (options.node.lockstep)
    throw std::runtime_error(
        "--restart works in real time only: in lockstep a lost node ends the run. Start without "
        "--lockstep");
  if (options.ring.one_process)
    throw std::runtime_error("--restart needs one process per node. Start without --one-process");
}

/// A page that leads the hand needs a status, which a tool's keys do not permit.
void check_page(const UpOptions& options) {
  const device_node::Options& device = options.ring.device;
  device_node::check_hand_from(device.device, device.hand, options.node.lockstep);
  if (device.hand.from_page && !options.node.security.empty())
    throw std::runtime_error(
        "--hand-from page does not work with --security: the page's keys do not allow moving the "
        "hand. Start without --security, or with --motion");
}

RunSummary run_up(const UpOptions& options, const std::filesystem::path& choice) {
  check_restarts(options);
  check_page(options);
  require_all_keys(options);
  runtime::catch_signals();
  signal(SIGCHLD, [](int) {});  // is not to be ignored by `usleep`
  const scene::Scene scene = scene::load_scene(options.node.scene);
  std::unique_ptr<RunningNode> page;
  std::vector<std::string> warnings = scene.warnings;
  std::ranges::copy(warnings_of_machine(options.node.scheduling()), std::back_inserter(warnings));
  RingRun run(options, scene,
              {std::move(warnings), options.node.scene.string(),
               options.ring.device.device});  // first: others can answer its claim meanwhile
  const device_node::Options& device = options.ring.device;
  if (options.view || device.hand.from_page) {  // early, so that a long build is visible
    page = start_page(options.node, device.hand.from_page, options.browser, choice);
    run.set_page(*page);
  }
  const std::vector<std::string> notes = check_before_start(
      scene, {device.device, devices::parse_settings(device.settings), device.motion,
              device.device_file, options.no_record ? "" : options.ring.logger.bag,
              device.network_delay_ms, options.node.lockstep, device.hand.from_page});
  for (const std::string& note : notes)
    console::log("note: {}\n", note);
  return run.go();
}

/// A run that a page has chosen and that cannot start makes room for the one before.
RunSummary run_or_go_back(const UpOptions& options, const std::filesystem::path& choice) {
  const std::optional<NextRun> previous = take_previous();
  try {
    return run_up(options, choice);
  } catch (const std::exception& error) {
    if (!previous)
      throw;
    console::log("error: {}\n", error.what());
    become(options, *previous, false);
    throw;
  }
}

int up(const UpOptions& options) {
  auto choice = std::make_unique<ChoiceFolder>(options);
  const RunSummary summary = run_or_go_back(options, choice->file());
  const std::optional<NextRun> next = read_choice(choice->file());
  choice.reset();
  console::print_result("{}", options.json ? json_of(summary) : to_text(summary));
  if (!options.no_record)
    save_verdict(summary);
  if (!options.no_record && !options.no_report) {
    console::finish_results();  // the summary does not wait while a page is drawn
    report_on(summary);
  }
  if (next && !runtime::stop_requested().load()) {
    console::finish_results();
    become(options, *next, true);
  }
  return summary.verdict.passed() ? 0 : 1;
}

}  // namespace

void add_up(CLI::App& app, Action& action) {
  auto options = std::make_shared<UpOptions>();
  CLI::App* verb = app.add_subcommand("up");
  verb->add_option("SCENE", options->node.scene,
                   fmt::format("Scene file (YAML), or the name of a shipped scene: {}",
                               fmt::join(runtime::shipped_scenes(), ", ")))
      ->required()
      ->transform(runtime::scene_argument());
  runtime::add_node_options(*verb, options->node, false);
  verb->remove_option(verb->get_option("--peers"));
  device_node::add_device_options(*verb, options->ring.device);
  verb->add_option("--record", options->ring.logger.bag,
                   "Folder of the recording; it must not exist (default: " +
                       (recordings_folder() / "<scene>-<time>").string() + ")");
  logger::add_format_options(*verb, options->ring.logger.format);
  verb->add_option("--topic", options->ring.logger.topics,
                   "Also records this DDS topic (of a compiled-in type), such as rt/tf; repeatable")
      ->check(runtime::check_topic);
  verb->add_option("--validate-every", options->ring.validator.every,
                   "The validator checks every N-th sample")
      ->capture_default_str()
      ->check(runtime::require_count);
  const auto choose_limits = [options](const std::vector<std::string>& texts) {
    for (const std::string& text : texts)
      if (const std::string wrong = choose_limit(text, options->limits); !wrong.empty())
        throw CLI::ValidationError("--limit", wrong);
  };
  verb->add_option_function<std::vector<std::string>>(
          "--limit", choose_limits,
          "NAME=VALUE: sets a limit of the verdict; repeatable. List: "
          "deploy/doc/reference/limits.md")
      ->allow_extra_args(false);
  verb->add_flag("--no-record", options->no_record, "No logger and no recording");
  verb->add_flag("--no-report", options->no_report, "Writes no report.html");
  verb->add_flag("--one-process", options->ring.one_process,
                 "All nodes in one process; still over DDS");
  verb->add_option(
          "--restart", options->restarts,
          "Restarts a rendering, coupling, validator or logger that ended, at most N times")
      ->option_text("N")
      ->check(runtime::require_whole);
  verb->add_flag(
      "--view", options->view,
      "Serves a page that shows the ring, and prints its address (also with --hand-from page)");
  verb->add_flag("--browser", options->browser, "Opens the page in the browser, if available");
  verb->add_flag("--json", options->json,
                 "Prints the summary as one JSON object on stdout, the rest on stderr");
  verb->callback([options, &action] { action = [options] { return up(*options); }; });
}

}  // namespace voxtouch::cli
