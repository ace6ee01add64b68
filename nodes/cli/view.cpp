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
                   "A bag's folder, a scene file (YAML) or the name of a scene that comes with "
                   "voxtouch; default: the scene that the ring itself names")
      ->transform(CLI::Validator(
          [](std::string& shown) {
            std::error_code error;
            return std::filesystem::exists(shown, error) ? "" : runtime::scene_argument()(shown);
          },
          ""))
      ->option_text("[BAG|SCENE]");
  runtime::add_rig_options(*verb, o->node);
  verb->add_option("--address", o->server.address,
                   "IPv4 address to serve at; another than 127.0.0.1 shows the page to a network")
      ->capture_default_str();
  CLI::Option* port =
      verb->add_option(
              "--port", o->server.port,
              "Port to serve at; 0: any that is free. Default: 8765, or any where that is taken")
          ->check(CLI::Range(0, 65535));
  verb->add_flag("--lead-hand", o->leads_hand,
                 "Pages move the hand of the ring's device, which runs with --hand-from page "
                 "(voxtouch up sets this)");
  verb->add_flag("--browser", o->opens_browser, "Opens the page in the browser, if there is one");
  verb->add_option("--with-parent", o->parent,
                   "Stop when this parent process dies, and print the address on stderr (voxtouch "
                   "up sets this)");
  verb->callback([o, port, &action] {
    o->server.port_is_requested = port->count() > 0;
    o->to_stderr = o->parent != 0;
    action = [o] { return view(*o); };
  });
}

}  // namespace voxtouch::cli
