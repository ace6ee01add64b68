#include "nodes/cli/up/page_process.hpp"

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

extern char** environ;

namespace voxtouch::cli {

PageProcess::PageProcess(const runtime::NodeOptions& o) {
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  std::vector<std::string> texts = {program,       "view",
                                    o.scene.string(), "--rig",
                                    o.rig,         "--domain",
                                    fmt::to_string(o.domain), "--interface",
                                    o.network_interface, "--with-parent",
                                    fmt::to_string(getpid())};
  std::vector<char*> argv;
  for (std::string& text : texts) argv.push_back(text.data());
  argv.push_back(nullptr);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);  // Ctrl-C is for `up`, which ends it last
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", 0, 0);
  const int error = posix_spawn(&pid_, program.c_str(), &actions, &attributes, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) throw std::runtime_error(fmt::format("the page could not be started: {}", std::strerror(error)));
}

PageProcess::~PageProcess() {
  ::kill(pid_, SIGTERM);
  constexpr int kTurns = 200;
  for (int n = 0; n < kTurns; ++n, usleep(10'000))
    if (waitpid(pid_, nullptr, WNOHANG) != 0) return;
  ::kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

}  // namespace voxtouch::cli
