#include "nodes/cli/child_program.hpp"

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
#include <thread>

#include <fmt/format.h>

namespace voxtouch::cli {
namespace {

/// A file without a name. Neither side waits for the other to read, as with a pipe.
using MemoryFile = std::unique_ptr<std::FILE, decltype([](std::FILE* file) { std::fclose(file); })>;

MemoryFile memory_file(const std::string& content) {
  const int number = ::memfd_create("voxtouch_child", MFD_CLOEXEC);
  MemoryFile file(number < 0 ? nullptr : ::fdopen(number, "w+b"));
  if (!file || std::fwrite(content.data(), 1, content.size(), file.get()) != content.size() ||
      std::fflush(file.get()) != 0)
    throw std::runtime_error(
        fmt::format("Cannot create a pipe to a child process: {}", std::strerror(errno)));
  std::rewind(file.get());
  return file;
}

std::string text_of(std::FILE* file) {
  std::string text;
  std::array<char, 4096> part{};
  std::rewind(file);
  while (const std::size_t count = std::fread(part.data(), 1, part.size(), file))
    text.append(part.data(), count);
  while (!text.empty() && text.back() == '\n')
    text.pop_back();
  return text;
}

pid_t start(std::vector<std::string> words, int input, int output, bool by_itself) {
  std::vector<char*> argv;
  for (std::string& word : words)
    argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  if (by_itself)
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  pid_t child = -1;
  const int error = ::posix_spawnp(&child, argv[0], &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    throw std::runtime_error(fmt::format("Cannot start {}: {}", argv[0], std::strerror(error)));
  return child;
}

void notify_listener(const ChildProgram& program, int output) {
  if (!program.listen)
    return;
  std::array<char, 8192> part{};
  const ssize_t size =
      ::pread(output, part.data(), part.size(), 0);  // leaves the file position unchanged
  program.listen({part.data(), size > 0 ? static_cast<std::size_t>(size) : 0});
}

}  // namespace

std::optional<Ended> run_program(const ChildProgram& program) {
  const MemoryFile in = memory_file(program.input), out = memory_file({});
  const pid_t child =
      start(program.words, ::fileno(in.get()), ::fileno(out.get()), program.patience.has_value());
  const auto begun = std::chrono::steady_clock::now();
  for (int status = 0;; std::this_thread::sleep_for(std::chrono::milliseconds(20))) {
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child)
      return Ended{status, text_of(out.get())};
    if (ended < 0 && errno != EINTR)
      throw std::runtime_error(
          fmt::format("Lost child process {}: {}", program.words.front(), std::strerror(errno)));
    if (program.patience && std::chrono::steady_clock::now() - begun > *program.patience)
      return std::nullopt;
    notify_listener(program, ::fileno(out.get()));
  }
}

}  // namespace voxtouch::cli
