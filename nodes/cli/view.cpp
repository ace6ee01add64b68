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
  CLI::App* verb = app.add_subcommand(
      "view",
      "Shows a ring while it runs, or a recorded run, as a page in a browser: the scene, tool and "
      "forces in 3-D, the last ten seconds\n"
      "as charts, the nodes, and the effects with switches. Prints the page's address and serves "
      "it until Ctrl-C.\n"
      "  voxtouch view                                the ring of this rig, also one that starts "
      "later\n"
      "  voxtouch view deploy/scenes/cup.yaml         with this file's meshes, where the ring runs "
      "on another host\n"
      "  voxtouch view BAG                            a bag, with play, speed and any place\n"
      "  voxtouch up deploy/scenes/cup.yaml --view    a ring with its page\n"
      "The ring does not notice: the page taps it as a logger does. The address holds a random "
      "token, and nobody gets in without it;\n"
      "nothing is served on the network unless --address says so. Needs libjs-three and "
      "libjs-dygraphs (deploy/setup).");
  verb->add_option("SHOWN", o->shown,
                   "A bag's folder, a scene file (YAML) or the name of a scene that comes with "
                   "voxtouch; default: the scene that the ring itself names")
      ->transform(CLI::Validator(
          [](std::string& shown) {
            return std::filesystem::exists(shown) ? "" : runtime::scene_argument()(shown);
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
  scene_build::add_cache_options(*verb, o->cache);
  verb->add_option(
      "--with-parent", o->parent,
      "Stop when this parent process dies, and tell the address on stderr (voxtouch up sets this)");
  verb->callback([o, port, &action] {
    o->server.port_is_wished = port->count() > 0;
    o->to_stderr = o->parent != 0;
    action = [o] { return view(*o); };
  });
}

}  // namespace voxtouch::cli
