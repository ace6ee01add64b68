#include "nodes/cli/up/restarts.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

namespace voxtouch::cli {
namespace {

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

/// The lowest energy account minus the bound of a sound contact; the bound is an extreme of the
/// same process.
double debt(const runtime::Figures& figures, const std::string& axis) {
  const double lowest_j = runtime::value_of(figures, "lowest_energy" + axis + "_j");
  const double bound_j = runtime::value_of(figures, "energy_bound" + axis + "_j");
  return lowest_j >= 0.0 ? 0.0 : -lowest_j / std::max(bound_j, 1e-300);
}

}  // namespace

std::string how_ended(int status) {
  return status > 128 ? fmt::format("signal {}", status - 128) : fmt::format("status {}", status);
}

runtime::NodeReport over_all_processes(const runtime::NodeReport& earlier,
                                       runtime::NodeReport now) {
  // A process without an answer has no first sample.
  if (runtime::find_value(earlier.figures, "samples") == 0.0)
    return now;
  for (const auto& [name, before] : earlier.figures) {
    const auto [figure, was_missing] = now.figures.try_emplace(name, before);
    if (was_missing)
      continue;
    double& value = figure->second.value;
    if (is_one_of(before.unit, {"samples", "messages", "commands", "times", "changes", "requests",
                                "reloads", "designs"}))
      value += before.value;
    else if (before.unit == "sample number")
      value = before.value;
    else if (name.starts_with("stiffness_") || name.contains("most_") || name.contains("longest_"))
      value = std::max(value, before.value);
  }
  for (const std::string axis : {"", "_rotation"}) {
    if (debt(earlier.figures, axis) <= debt(now.figures, axis))
      continue;
    for (const std::string& name : {"lowest_energy" + axis + "_j", "energy_bound" + axis + "_j"})
      now.figures[name] = earlier.figures.at(name);
  }
  return now;
}

}  // namespace voxtouch::cli
