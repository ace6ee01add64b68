#include <chrono>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "nodes/cli/plot_tool.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/log/tell.hpp"
#include "nodes/replay/replay_report.hpp"
#include "nodes/runtime/scene_argument.hpp"

namespace voxtouch::cli {
namespace {

struct ReplayVerb {
  replay::ReplayOptions options;
  std::filesystem::path picture;
  bool json = false;
};

int replay_bag(ReplayVerb o) {
  if (!o.picture.empty()) check_picture(o.picture);
  o.options.curves = !o.picture.empty();
  const auto begun = std::chrono::steady_clock::now();
  const replay::Replayed replayed = replay::replay(o.options);
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  log::tell("replayed {:.1f} s in {:.1f} s\n", replayed.duration_s, took_s);
  if (!o.picture.empty()) log::tell("{}\n", draw_picture("replay", replay::to_plot(replayed).dump(), o.picture));
  if (o.json)
    log::print_result("{}\n", replay::to_json(replayed).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  else
    log::print_result("{}", replay::to_text(replayed));
  return replayed.equal() && replayed.contact.compared + replayed.command.compared > 0 ? 0 : 1;
}

}  // namespace

void add_replay(CLI::App& app, Action& action) {
  auto o = std::make_shared<ReplayVerb>();
  CLI::App* verb = app.add_subcommand(
      "replay",
      "Takes the device samples of a bag through rendering and coupling once more, offline and as fast as it goes, and holds each contact and\n"
      "each command against the recorded one, bit by bit. Exit status 0 where all is equal, 1 where something differs or the bag cannot be\n"
      "replayed.\n"
      "  voxtouch replay BAG                                   what this build makes of a recorded run\n"
      "  voxtouch replay BAG --scene mine.yaml --plot out.png  what a change of the scene does to the recorded hand\n"
      "The hand does not feel what is replayed: it moves as it was recorded.");
  verb->add_option("BAG", o->options.bag, "A bag's folder, or one of its files")->required()->check(CLI::ExistingPath);
  verb->add_option("--scene", o->options.scene, "This scene instead of the one that the bag names: a file, or the name of one that comes with voxtouch")
      ->transform(runtime::scene_argument());
  verb->add_option("--rig", o->options.rig, "Rig, where a bag holds several; default: the one that is there");
  verb->add_option("--plot", o->picture, "Draws recorded and replayed forces over time: .png, .svg or .pdf");
  scene_build::add_cache_options(*verb, o->options.cache);
  verb->add_flag("--json", o->json, "One JSON object on stdout; all else goes to stderr");
  verb->callback([o, &action] {
    action = [o] {
      try {
        return replay_bag(*o);
      } catch (const std::exception& error) {
        if (o->json) log::print_result("{}\n", nlohmann::ordered_json{{"ok", false}, {"problems", {error.what()}}}.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
        throw;
      }
    };
  });
}

}  // namespace voxtouch::cli
