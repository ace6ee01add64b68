#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <initializer_list>
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "core/types/program_folder.hpp"
#include "nodes/cli/new.hpp"
#include "nodes/cli/up/run_files.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/console/log.hpp"
#include "nodes/runtime/options.hpp"

namespace voxtouch::cli {
namespace {

namespace fs = std::filesystem;

struct TryOptions {
  std::string shown = "cup_virtual_tool", device = "sim-phantom";
  runtime::NodeOptions node;  ///< rig, domain, interface
  fs::path record;            ///< empty: no recording
  bool no_browser = false;
};

bool is_mesh(const fs::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
  constexpr std::array<std::string_view, 6> kEndings = {".obj",  ".stl", ".ply",
                                                        ".gltf", ".glb", ".dae"};
  std::error_code error;
  return std::ranges::find(kEndings, ending) != kEndings.end() && fs::exists(file, error);
}

/// Becomes `voxtouch up`: returns only if that cannot be started.
int exec_up(const TryOptions& o) {
  std::vector<std::string> words = {
      "voxtouch", "up",     is_mesh(o.shown) ? tried_scene(o.shown, o.device) : o.shown,
      "--device", o.device, "--hand-from",
      "page"};
  const auto add = [&words](std::initializer_list<std::string> more) {
    words.insert(words.end(), more);
  };
  add({"--rig", o.node.rig, "--domain", fmt::to_string(o.node.domain)});
  add({"--interface", o.node.network_interface});
  for (const std::string& peer : o.node.discovery_peers)
    add({"--discovery-peer", peer});
  if (!o.node.security.empty())
    add({"--security", o.node.security.string()});
  if (o.record.empty())
    add({"--no-record"});
  else
    add({"--record", o.record.string()});
  if (!o.no_browser)
    add({"--browser"});
  std::vector<char*> argv;
  for (std::string& word : words)
    argv.push_back(word.data());
  argv.push_back(nullptr);
  console::flush_log();
  const fs::path program = program_folder() / "voxtouch";
  ::execv(program.c_str(), argv.data());
  throw std::runtime_error(
      fmt::format("Cannot start {} ({})", program.string(), std::strerror(errno)));
}

}  // namespace

fs::path tried_folder() {
  const fs::path folder = recordings_folder() / "tried";
  fs::create_directories(folder);
  return folder;
}

std::string tried_scene(const fs::path& mesh, const std::string& device) {
  const fs::path out = tried_folder() / (mesh.stem().string() + ".yaml");
  fs::remove(out);
  write_first_scene(mesh, device, out);
  return out.string();
}

void add_try(CLI::App& app, Action& action) {
  auto o = std::make_shared<TryOptions>();
  CLI::App* verb = app.add_subcommand("try");
  verb->add_option("SHOWN", o->shown, "Scene as for `up`, or mesh as for `new`")
      ->capture_default_str()
      ->option_text("[SCENE|MESH]");
  verb->add_option("--device", o->device, "Simulated device")->capture_default_str();
  verb->add_flag("--no-browser", o->no_browser,
                 "Prints the page's address without opening a browser");
  verb->add_option("--record", o->record, "Folder of a recording; default: none");
  runtime::add_rig_options(*verb, o->node);
  verb->callback([o, &action] { action = [o] { return exec_up(*o); }; });
}

}  // namespace voxtouch::cli
