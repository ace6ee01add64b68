#include "nodes/cli/plot_tool.hpp"

#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "core/types/program_folder.hpp"

namespace voxtouch::cli {
namespace {

/// Debian's own, whose matplotlib python3-matplotlib is; another python3 before it on PATH may have none.
constexpr const char* kDebianPython = "/usr/bin/python3";

/// A file without a name. Neither side waits for the other to read, as with a pipe.
using MemoryFile = std::unique_ptr<std::FILE, decltype([](std::FILE* file) { std::fclose(file); })>;

MemoryFile memory_file() {
  const int number = ::memfd_create("voxtouch_plot", MFD_CLOEXEC);
  MemoryFile file(number < 0 ? nullptr : ::fdopen(number, "w+b"));
  if (!file) throw std::runtime_error(fmt::format("voxtouch_plot could not be started: {}", std::strerror(errno)));
  return file;
}

std::string text_of(std::FILE* file) {
  std::string text;
  std::array<char, 4096> part{};
  std::rewind(file);
  while (const std::size_t count = std::fread(part.data(), 1, part.size(), file)) text.append(part.data(), count);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

pid_t start(std::vector<std::string> words, int input, int output) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output, STDERR_FILENO);
  pid_t child = -1;
  const int error = ::posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    throw std::runtime_error(
        fmt::format("Pictures are drawn by Python 3 with matplotlib, and {} could not be started ({}): install python3 "
                    "and python3-matplotlib (deploy/setup does)",
                    argv[0], std::strerror(error)));
  return child;
}

/// Runs the tool to its end with `input`; what it said.
std::string run_tool(const std::vector<std::string>& arguments, const std::string& input) {
  const std::filesystem::path tool = program_folder() / "voxtouch_plot";
  if (!std::filesystem::exists(tool))
    throw std::runtime_error(fmt::format("{} is not there, which draws pictures: build or install anew", tool.string()));
  const MemoryFile in = memory_file(), out = memory_file();
  if (std::fwrite(input.data(), 1, input.size(), in.get()) != input.size() || std::fflush(in.get()) != 0)
    throw std::runtime_error("voxtouch_plot could not be given its data: is there memory left?");
  std::rewind(in.get());
  std::vector<std::string> words{::access(kDebianPython, X_OK) == 0 ? kDebianPython : "python3", tool.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const pid_t child = start(std::move(words), ::fileno(in.get()), ::fileno(out.get()));
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const std::string said = text_of(out.get());
  if (WIFSIGNALED(status))
    throw std::runtime_error(fmt::format("voxtouch_plot was ended by signal {}. {}", WTERMSIG(status), said));
  if (status != 0) throw std::runtime_error(said.empty() ? "voxtouch_plot failed without a word" : said);
  return said;
}

}  // namespace

void check_picture(const std::filesystem::path& picture) { run_tool({"check", "--", picture.string()}, ""); }

std::string draw_picture(const std::string& kind, const std::string& json, const std::filesystem::path& picture) {
  return run_tool({kind, "--", "-", picture.string()}, json);
}

}  // namespace voxtouch::cli
