#include "nodes/cli/up/start_report.hpp"

#include <algorithm>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "nodes/cli/force_line.hpp"
#include "nodes/rendering/plan_warnings.hpp"

namespace voxtouch::cli {

std::vector<std::string> limited_warnings(const std::vector<std::string>& warnings,
                                          const std::string& scene) {
  std::vector<std::string> lines;
  for (const std::string& warning : warnings) {
    if (lines.size() == kWarningsAtStart)
      break;
    lines.push_back(fmt::format("warning: {}", warning));
  }
  if (warnings.size() > lines.size())
    lines.push_back(fmt::format("note: {} more; `voxtouch plan {}` and `voxtouch doctor` list all",
                                warnings.size() - lines.size(), scene));
  return lines;
}

std::vector<std::string> warnings_of_machine(const runtime::RealtimeOptions& options) {
  std::vector<std::string> refused;
  std::thread([&] { refused = runtime::refused_rights(options); }).join();  // of that thread only
  if (refused.empty())
    return {};
  return {fmt::format("{} of the real-time rights {} refused; see `voxtouch doctor`",
                      refused.size(), refused.size() == 1 ? "is" : "are")};
}

StartReport::StartReport(std::vector<std::string> warnings, std::string scene, std::string device)
    : warnings_(std::move(warnings)),
      scene_(std::move(scene)),
      device_(std::move(device)) {}

bool StartReport::scene_is_built(const Reports& reports) {
  const auto rendering = reports.find("rendering");
  return rendering != reports.end() &&
         rendering->second.figures.contains(rendering_node::kPlanWarnings);
}

std::vector<std::string> StartReport::poll(const Reports& reports) {
  std::vector<std::string> lines;
  if (!warned_ && scene_is_built(reports)) {
    warned_ = true;
    std::vector<std::string> all = rendering_node::plan_warnings_in(reports.at("rendering"));
    for (const std::string& warning : warnings_)
      if (std::ranges::find(all, warning) == all.end())
        all.push_back(warning);
    lines = limited_warnings(all, scene_);
  }
  const auto limit = device_fit::stiffness_limit_of(word(reports, "coupling", "stiffness_limit"));
  if (!previewed_ && limit) {
    previewed_ = true;
    const auto figure = [&](const char* name) { return number(reports, "coupling", name); };
    const device_fit::ForcePreview preview{
        .stiffness_n_per_m = figure("certified_stiffness_n_per_m"),
        .gain_margin = figure("design_gain_margin"),
        .force_n = figure("saturation_force_n"),
        .depth_m = figure("saturation_depth_m"),
        .limit = *limit,
        .rotation_nm_per_rad = figure("spring_nm_per_rad"),
        .reach_m = number(reports, "rendering", "tool_reach_m"),
        .grip_n_per_m = figure("requested_grip_n_per_m")};
    for (const std::string& line : force_lines(preview, device_))
      lines.push_back("note: " + line);
    if (word(reports, "coupling", "returns_torque") == "no")
      lines.push_back(fmt::format("note: {}", kRotationIsLatched));
  }
  return lines;
}

}  // namespace voxtouch::cli
