#include "nodes/cli/up/start_warnings.hpp"

#include <thread>

#include <fmt/format.h>

namespace voxtouch::cli {

std::vector<std::string> few_warnings(const std::vector<std::string>& warnings,
                                      const std::string& scene) {
  std::vector<std::string> lines;
  for (const std::string& warning : warnings) {
    if (lines.size() == kWarningsAtStart)
      break;
    lines.push_back(fmt::format("warning: {}", warning));
  }
  if (warnings.size() > lines.size())
    lines.push_back(
        fmt::format("note: {} more; `voxtouch plan {}` and `voxtouch doctor` tell them all",
                    warnings.size() - lines.size(), scene));
  return lines;
}

std::vector<std::string> warnings_of_machine(const runtime::RealtimeOptions& options) {
  std::vector<std::string> refused;
  std::thread([&] { refused = runtime::refused_rights(options); }).join();  // of that thread only
  if (refused.empty())
    return {};
  return {
      fmt::format("{} of the rights that keep samples in time {} refused: `voxtouch doctor` says "
                  "which, and what to do",
                  refused.size(), refused.size() == 1 ? "is" : "are")};
}

}  // namespace voxtouch::cli
