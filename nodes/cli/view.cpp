#include "nodes/view/view.hpp"

#include <memory>

#include <CLI/CLI.hpp>

#include "nodes/cli/verbs.hpp"
#include "nodes/runtime/scene_argument.hpp"
#include "nodes/runtime/signals.hpp"

namespace voxtouch::cli {
namespace {

struct ViewOptions : view::Options {
  int parent = 0;
};

int view(const ViewOptions& o) {
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
