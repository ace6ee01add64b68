#pragma once
/// Warnings of the built scene in the status of the rendering. They are available when a session
/// begins.
#include <cstddef>
#include <string>
#include <vector>

#include "nodes/runtime/node_registry.hpp"

namespace voxtouch::rendering_node {

/// Name of the figure that counts the warnings. Present once the scene is built.
inline constexpr char kPlanWarnings[] = "warnings";
/// Number of warnings that the status contains in full.
inline constexpr std::size_t kMaxPlanWarnings = 16;

inline std::string plan_warning_key(std::size_t n) {
  return "plan_warning_" + std::to_string(n + 1);
}

inline void put_plan_warnings(const std::vector<std::string>& warnings,
                              runtime::NodeReport& report) {
  for (std::size_t n = 0; n < warnings.size() && n < kMaxPlanWarnings; ++n)
    report.values[plan_warning_key(n)] = warnings[n];
}

inline std::vector<std::string> plan_warnings_in(const runtime::NodeReport& report) {
  std::vector<std::string> warnings;
  for (std::size_t n = 0; n < kMaxPlanWarnings; ++n)
    if (const auto found = report.values.find(plan_warning_key(n)); found != report.values.end())
      warnings.push_back(found->second);
  return warnings;
}

}  // namespace voxtouch::rendering_node
