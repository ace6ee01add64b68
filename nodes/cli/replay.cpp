#include <stdlib.h>
#include <sys/wait.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "nodes/cli/child_program.hpp"
#include "nodes/cli/plot_tool.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/console/log.hpp"
#include "nodes/console/progress.hpp"
#include "nodes/replay/replay_report.hpp"
#include "nodes/runtime/scene_argument.hpp"

namespace voxtouch::cli {
namespace {

struct ReplayVerb {
  replay::ReplayOptions options;
  std::filesystem::path picture;
  std::filesystem::path answers;  ///< folder for the bag with this build's answers; empty: none
  std::filesystem::path against;  ///< another build: its folder or its program; empty: none
  bool json = false;
};

/// A private folder of this process, removed with it.
class OwnFolder {
 public:
  OwnFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "voxtouch_replay_XXXXXX").string();
    if (!::mkdtemp(name.data()))
      throw std::runtime_error(fmt::format("Cannot create a folder in {}: {}",
                                           std::filesystem::temp_directory_path().string(),
                                           std::strerror(errno)));
    path = name;
  }
  ~OwnFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  OwnFolder(const OwnFolder&) = delete;
  OwnFolder& operator=(const OwnFolder&) = delete;
  std::filesystem::path path;
};

std::filesystem::path program_of(const std::filesystem::path& build) {
  for (const std::filesystem::path& program :
       {build / "bin" / "voxtouch", build / "voxtouch", build})
    if (std::filesystem::is_regular_file(program))
      return std::filesystem::absolute(program);
  throw std::runtime_error(fmt::format(
      "No program 'voxtouch' in {}. --against takes a build folder or the program itself",
      build.string()));
}

std::string last_line(const std::string& said) { return said.substr(said.rfind('\n') + 1); }

/// Replays the recording with another build, into a bag.
void replay_by_other(const ReplayVerb& o, const std::filesystem::path& made) {
  const std::string program = program_of(o.against).string();
  ChildProgram child{
      .words = {program, "replay", o.options.bag.string(), "--write", made.string()}};
  if (!o.options.scene.empty())
    child.words.insert(child.words.end(), {"--scene", o.options.scene.string()});
  if (!o.options.rig.empty())
    child.words.insert(child.words.end(), {"--rig", o.options.rig});
  child.listen = [report = console::log_each_second("replay"), &program](std::string_view) mutable {
    report(program + " replays");
  };
  const Ended ended = *run_program(child);
  if (WIFSIGNALED(ended.status))
    throw std::runtime_error(fmt::format("{} ended by signal {} during the replay. {}", program,
                                         WTERMSIG(ended.status), last_line(ended.said)));
  if (!std::filesystem::exists(
          made / "metadata.yaml"))  // its exit status states the verdict on the recording
    throw std::runtime_error(
        fmt::format("{} wrote no replay of the recording (it may lack `replay --write`): {}",
                    program, last_line(ended.said)));
}

replay::Replayed replay_once(const ReplayVerb& o) {
  if (o.against.empty())
    return replay::replay(o.options);
  const OwnFolder folder;
  replay::ReplayOptions options = o.options;
  options.bag = folder.path / "made";
  replay_by_other(o, options.bag);
  replay::Replayed replayed = replay::replay(options);
  replayed.bag = o.options.bag.string(), replayed.other_build = o.against.string();
  return replayed;
}

int replay_bag(ReplayVerb o) {
  if (!o.picture.empty())
    check_picture(o.picture);
  o.options.curves = !o.picture.empty(), o.options.answers = !o.answers.empty();
  const auto begun = std::chrono::steady_clock::now();
  const replay::Replayed replayed = replay_once(o);
  const double took_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  console::log("replayed {:.1f} s in {:.1f} s\n", replayed.duration_s, took_s);
  if (!o.answers.empty())
    replay::write_replayed(o.options.bag, replayed.rig, replayed.answers, o.answers);
  if (!o.picture.empty())
    console::log("{}\n", draw_picture("replay", replay::to_plot(replayed).dump(), o.picture));
  if (o.json)
    console::print_result(
        "{}\n", replay::to_json(replayed).dump(2, ' ', false,
                                               nlohmann::ordered_json::error_handler_t::replace));
  else
    console::print_result("{}", replay::to_text(replayed));
  return replayed.passed() ? 0 : 1;
}

}  // namespace

void add_replay(CLI::App& app, Action& action) {
  auto o = std::make_shared<ReplayVerb>();
  CLI::App* verb = app.add_subcommand("replay");
  verb->add_option("BAG", o->options.bag, "Folder of a recording, or one of its files")
      ->required()
      ->check(CLI::ExistingPath);
  verb->add_option("--scene", o->options.scene,
                   "Scene instead of the recorded one: a file, or the name of a shipped scene")
      ->transform(runtime::scene_argument());
  verb->add_option("--rig", o->options.rig,
                   "Rig, if the recording holds several; default: the only one");
  auto* write = verb->add_option("--write", o->answers,
                                 "Folder for a copy of the recording with this build's contacts "
                                 "and commands; it must not exist");
  verb->add_option("--against", o->against,
                   "Compares with the replay of another build (its folder or program), not with "
                   "the recorded values")
      ->check(CLI::ExistingPath)
      ->excludes(write);
  verb->add_option("--plot", o->picture,
                   "Plots recorded and replayed forces over time (.png, .svg or .pdf)");
  verb->add_flag("--json", o->json, "Prints one JSON object on stdout, the rest on stderr");
  verb->callback([o, &action] {
    action = [o] {
      try {
        return replay_bag(*o);
      } catch (const std::exception& error) {
        if (o->json)
          console::print_result(
              "{}\n", nlohmann::ordered_json{{"ok", false}, {"problems", {error.what()}}}.dump(
                          2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
        throw;
      }
    };
  });
}

}  // namespace voxtouch::cli
