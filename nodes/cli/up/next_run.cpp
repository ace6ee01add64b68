#include "nodes/cli/up/next_run.hpp"

#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "core/types/program_folder.hpp"
#include "nodes/console/log.hpp"

namespace voxtouch::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSceneVariable = "VOXTOUCH_PREVIOUS_SCENE";
constexpr const char* kDeviceVariable = "VOXTOUCH_PREVIOUS_DEVICE";

std::string taken(const char* variable) {
  const char* const value = std::getenv(variable);
  std::string text = value ? value : "";
  ::unsetenv(variable);
  return text;
}

}  // namespace

ChoiceFolder::ChoiceFolder(const UpOptions& options) {
  if (!options.no_record || options.json || !options.ring.device.hand.from_page)
    return;
  std::string folder = (fs::temp_directory_path() / "voxtouch-XXXXXX").string();
  if (::mkdtemp(folder.data()))
    folder_ = folder;
}

ChoiceFolder::~ChoiceFolder() {
  std::error_code ignored;
  if (!folder_.empty())
    fs::remove_all(folder_, ignored);
}

std::optional<NextRun> read_choice(const fs::path& file) {
  std::ifstream in(file);
  NextRun next;
  if (std::getline(in, next.scene) && std::getline(in, next.device) && std::getline(in, next.page))
    return next;
  return std::nullopt;
}

std::optional<NextRun> take_previous() {
  NextRun previous{taken(kSceneVariable), taken(kDeviceVariable), ""};
  const char* const page = std::getenv(kPageVariable);
  if (previous.scene.empty() || previous.device.empty() || !page)
    return std::nullopt;
  previous.page = page;
  return previous;
}

void become(const UpOptions& options, const NextRun& next, bool can_go_back) {
  const runtime::NodeOptions& node = options.node;
  std::vector<std::string> words = {"voxtouch",    "up",
                                    next.scene,    "--device",
                                    next.device,   "--hand-from",
                                    "page",        "--no-record",
                                    "--rig",       node.rig,
                                    "--domain",    fmt::to_string(node.domain),
                                    "--interface", node.network_interface};
  for (const std::string& peer : node.discovery_peers)
    words.insert(words.end(), {"--discovery-peer", peer});
  ::setenv(kPageVariable, next.page.c_str(), 1);
  if (can_go_back) {
    ::setenv(kSceneVariable, node.scene.c_str(), 1);
    ::setenv(kDeviceVariable, options.ring.device.device.c_str(), 1);
  }
  std::vector<char*> argv;
  for (std::string& word : words)
    argv.push_back(word.data());
  argv.push_back(nullptr);
  console::log("\nnext: {} on {}\n", next.scene, next.device);
  console::flush_log();
  const fs::path program = program_folder() / "voxtouch";
  ::execv(program.c_str(), argv.data());
  throw std::runtime_error(
      fmt::format("{} cannot be started ({})", program.string(), std::strerror(errno)));
}

}  // namespace voxtouch::cli
