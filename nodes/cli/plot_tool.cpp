#include "nodes/cli/plot_tool.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/types/program_folder.hpp"
#include "nodes/cli/child_program.hpp"
#include "nodes/console/progress.hpp"

namespace voxtouch::cli {
namespace {

/// Debian's, for which python3-matplotlib is installed; another python3 on PATH may lack it.
constexpr const char* kDebianPython = "/usr/bin/python3";

/// Prefix of a progress line, which is not part of the result.
constexpr std::string_view kProgress = "progress ";

/// The last progress line of the output so far; empty without one.
std::string last_progress(std::string_view said) {
  const std::size_t at = said.rfind(kProgress),
                    end = said.find('\n', at == said.npos ? said.size() : at);
  return end == said.npos
             ? ""
             : std::string(said.substr(at + kProgress.size(), end - at - kProgress.size()));
}

std::string without_progress(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1);
    if (const std::string line = text.substr(at, end + 1 - at); !line.starts_with(kProgress))
      out += line;
    at = end + 1;
  }
  while (!out.empty() && out.back() == '\n')
    out.pop_back();
  return out;
}

using Patience = std::optional<std::chrono::milliseconds>;

/// Runs the tool with `input`, isolated (-I) from packages and settings of the user's Python, until
/// it ends or patience is over. Returns its output.
std::optional<std::string> run_tool(const std::vector<std::string>& arguments,
                                    const std::string& input, Patience patience = std::nullopt) {
  const std::filesystem::path tool = program_folder() / "voxtouch_plot";
  if (!std::filesystem::exists(tool))
    throw std::runtime_error(
        fmt::format("Plot program {} not found. Build or install voxtouch again", tool.string()));
  const auto log_line = console::log_each_second("report");
  ChildProgram program{
      {::access(kDebianPython, X_OK) == 0 ? kDebianPython : "python3", "-I", tool.string()},
      input,
      patience,
      [&](std::string_view said) {
        if (const std::string fraction = last_progress(said); !fraction.empty())
          log_line(fraction + " %");
      }};
  program.words.insert(program.words.end(), arguments.begin(), arguments.end());
  std::optional<Ended> ended;
  try {
    ended = run_program(program);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(
        fmt::format("Plots need Python 3 with matplotlib. Install python3 and python3-matplotlib "
                    "(deploy/setup does). {}",
                    error.what()));
  }
  if (!ended)
    return std::nullopt;
  const std::string said = without_progress(ended->said);
  if (WIFSIGNALED(ended->status))
    throw std::runtime_error(
        fmt::format("voxtouch_plot ended by signal {}. {}", WTERMSIG(ended->status), said));
  if (ended->status != 0)
    throw std::runtime_error(said.empty() ? "voxtouch_plot failed without a message" : said);
  return said;
}

}  // namespace

void check_picture(const std::filesystem::path& picture, bool may_be_page) {
  std::vector<std::string> words{"check"};
  if (may_be_page)
    words.emplace_back("--page");
  words.insert(words.end(), {"--", picture.string()});
  run_tool(words, "");
}

std::string draw_picture(const std::string& kind, const std::string& json,
                         const std::filesystem::path& picture) {
  return *run_tool({kind, "--", "-", picture.string()}, json);
}

std::optional<std::string> write_report(const Report& report, Patience patience) {
  std::vector<std::string> words{"report", "--progress", "--rig=" + report.rig};
  if (!report.compared.empty())
    words.push_back("--compare-with=" + report.compared.string());
  words.insert(words.end(), {"--", report.bag.string(), report.page.string()});
  return run_tool(words, "", patience);
}

}  // namespace voxtouch::cli
