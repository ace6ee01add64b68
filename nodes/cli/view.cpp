#include "nodes/view/view.hpp"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>

#include <CLI/CLI.hpp>

#include "core/scene/scene_file.hpp"
#include "nodes/cli/new.hpp"
#include "nodes/cli/plot_tool.hpp"
#include "nodes/cli/up/next_run.hpp"
#include "nodes/cli/up/run_files.hpp"
#include "nodes/cli/up/up_checks.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/runtime/scene_argument.hpp"
#include "nodes/runtime/signals.hpp"

namespace voxtouch::cli {
namespace {

struct ViewOptions : view::Options {
  int parent = 0;
};

void check_next(const view::Next& next) {
  std::string scene = next.scene;
  if (const std::string wrong = runtime::scene_argument()(scene); !wrong.empty())
    throw std::runtime_error(wrong);
  (void)check_before_start(scene::load_scene(scene), {.device = next.device,
                                                      .settings = {},
                                                      .motion = {},
                                                      .device_file = {},
                                                      .bag = {},
                                                      .hand_from_page = true});
}

std::string propose_scene(const std::string& bytes, const std::string& ending,
                          const std::string& device) {
  const std::filesystem::path mesh = tried_folder() / ("dropped" + ending);
  if (!(std::ofstream(mesh, std::ios::binary) << bytes).flush())
    throw std::runtime_error(mesh.string() + " cannot be written");
  return tried_scene(mesh, device);
}

/// Uses the address of the previous ring's page, so that browsers reconnect.
void take_over_page(view::ServerOptions& server) {
  const char* const address = std::getenv(kPageVariable);
  std::array<char, 33> token{};
  int port = 0;
  if (!address ||
      std::sscanf(address, "http://%*[0-9.]:%d/?token=%32[0-9a-f]", &port, token.data()) != 2)
    return;
  server.port = port;
  server.token = token.data();
}

/// Like the folder of a run's recording, with "last" for the last seconds.
view::SaveActions save_actions(const runtime::NodeOptions& node) {
  return {[&node](const std::string& scene) { return make_default_bag(scene + "-last", node); },
          [](const std::filesystem::path& folder) {
            (void)write_report({.bag = folder, .page = folder / "report.html"});
          }};
}

int view(ViewOptions o) {
  o.save = save_actions(o.node);
  if (!o.choice.empty()) {
    o.next = {check_next, propose_scene};
    take_over_page(o.server);
  }
  runtime::catch_signals();
  if (o.parent)
    runtime::die_with_parent(o.parent);
  return view::run(o, runtime::stop_requested());
}

}  // namespace

void add_view(CLI::App& app, Action& action) {
  auto o = std::make_shared<ViewOptions>();
  CLI::App* verb = app.add_subcommand("view");
  verb->add_option("SHOWN", o->shown,
                   "Folder of a recording, scene file (YAML) or name of a shipped scene; default: "
                   "the running ring's scene")
      ->transform(CLI::Validator(
          [](std::string& shown) {
            std::error_code error;
            return std::filesystem::exists(shown, error) ? "" : runtime::scene_argument()(shown);
          },
          ""))
      ->option_text("[BAG|SCENE]");
  runtime::add_rig_options(*verb, o->node);
  verb->add_option("--address", o->server.address,
                   "IPv4 address of the server; other than 127.0.0.1, the page is reachable from "
                   "the network")
      ->capture_default_str();
  CLI::Option* port =
      verb->add_option(
              "--port", o->server.port,
              "Port of the server; 0: any free one. Default: 8765, or any free one if it is in use")
          ->check(CLI::Range(0, 65535));
  verb->add_flag(
      "--lead-hand", o->leads_hand,
      "The page moves the simulated hand of a ring with --hand-from page (set by voxtouch up)");
  verb->add_flag("--browser", o->opens_browser, "Opens the page in the browser, if available");
  verb->add_option("--choice", o->choice,
                   "File for the page's choice of the next scene and device (set by voxtouch up)");
  verb->add_option(
      "--with-parent", o->parent,
      "Stops when this parent process ends, and prints the address on stderr (set by voxtouch up)");
  verb->callback([o, port, &action] {
    o->server.port_is_requested = port->count() > 0;
    o->to_stderr = o->parent != 0;
    action = [o] { return view(*o); };
  });
}

}  // namespace voxtouch::cli
