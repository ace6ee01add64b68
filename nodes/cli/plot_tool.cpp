#include "nodes/cli/plot_tool.hpp"

#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "core/types/program_folder.hpp"
#include "nodes/log/progress.hpp"

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

/// `by_itself`: in a session of its own, where no Ctrl-C of this program's terminal reaches it.
pid_t start(std::vector<std::string> words, int input, int output, bool by_itself) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  if (by_itself) posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  pid_t child = -1;
  const int error = ::posix_spawnp(&child, argv[0], &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    throw std::runtime_error(
        fmt::format("Pictures are drawn by Python 3 with matplotlib, and {} could not be started ({}): install python3 "
                    "and python3-matplotlib (deploy/setup does)",
                    argv[0], std::strerror(error)));
  return child;
}

/// What the tool says on the way, which is no part of what it says in the end.
constexpr std::string_view kProgress = "progress ";

/// The last of these words among what has been written so far, whose place to write on is left as it is; empty where there is none.
std::string last_progress(int output) {
  std::array<char, 8192> part{};
  const ssize_t size = ::pread(output, part.data(), part.size(), 0);
  const std::string_view text(part.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  const std::size_t at = text.rfind(kProgress), end = text.find('\n', at == text.npos ? text.size() : at);
  return end == text.npos ? "" : std::string(text.substr(at + kProgress.size(), end - at - kProgress.size()));
}

std::string without_progress(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1);
    if (const std::string line = text.substr(at, end + 1 - at); !line.starts_with(kProgress)) out += line;
    at = end + 1;
  }
  while (!out.empty() && out.back() == '\n') out.pop_back();
  return out;
}

using Patience = std::optional<std::chrono::milliseconds>;

/// Waits for `child` and tells how far it is; its status, or nothing where it takes longer than `patience`.
std::optional<int> wait_for(pid_t child, int output, Patience patience) {
  const auto tell = log::tell_each_second("report");
  const auto begun = std::chrono::steady_clock::now();
  int status = 0;
  for (;;) {
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child) return status;
    if (ended < 0 && errno != EINTR) throw std::runtime_error(fmt::format("voxtouch_plot was lost: {}", std::strerror(errno)));
    if (patience && std::chrono::steady_clock::now() - begun > *patience) return std::nullopt;
    if (const std::string share = last_progress(output); !share.empty()) tell(share + " %");
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

/// Runs the tool with `input`, to its end or as long as there is patience; what it said.
std::optional<std::string> run_tool(const std::vector<std::string>& arguments, const std::string& input, Patience patience = std::nullopt) {
  const std::filesystem::path tool = program_folder() / "voxtouch_plot";
  if (!std::filesystem::exists(tool))
    throw std::runtime_error(fmt::format("{} is not there, which draws pictures: build or install anew", tool.string()));
  const MemoryFile in = memory_file(), out = memory_file();
  if (std::fwrite(input.data(), 1, input.size(), in.get()) != input.size() || std::fflush(in.get()) != 0)
    throw std::runtime_error("voxtouch_plot could not be given its data: is there memory left?");
  std::rewind(in.get());
  std::vector<std::string> words{::access(kDebianPython, X_OK) == 0 ? kDebianPython : "python3", tool.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const pid_t child = start(std::move(words), ::fileno(in.get()), ::fileno(out.get()), patience.has_value());
  const std::optional<int> status = wait_for(child, ::fileno(out.get()), patience);
  if (!status) return std::nullopt;
  const std::string said = without_progress(text_of(out.get()));
  if (WIFSIGNALED(*status))
    throw std::runtime_error(fmt::format("voxtouch_plot was ended by signal {}. {}", WTERMSIG(*status), said));
  if (*status != 0) throw std::runtime_error(said.empty() ? "voxtouch_plot failed without a word" : said);
  return said;
}

}  // namespace

void check_picture(const std::filesystem::path& picture) { run_tool({"check", "--", picture.string()}, ""); }

std::string draw_picture(const std::string& kind, const std::string& json, const std::filesystem::path& picture) {
  return *run_tool({kind, "--", "-", picture.string()}, json);
}

std::optional<std::string> write_report(const Report& report, Patience patience) {
  std::vector<std::string> words{"report", "--progress", "--rig=" + report.rig};
  if (!report.beside.empty()) words.push_back("--beside=" + report.beside.string());
  words.insert(words.end(), {"--", report.bag.string(), report.page.string()});
  return run_tool(words, "", patience);
}

}  // namespace voxtouch::cli
