#include "nodes/runtime/own_line.hpp"

#include <array>

#include <fmt/format.h>

namespace voxtouch::runtime {

std::string own_line(const std::string& node, const Figures& now, const Figures& before,
                     double seconds) {
  constexpr std::array kCounted{"samples", "checked",
                                "received"};  // what the nodes call what they take part in
  for (const char* const name : kCounted) {
    const auto figure = now.find(name);
    if (figure == now.end() || figure->second.value <= 0.0)
      continue;
    std::string line =
        fmt::format("{}: {:>7} {} at {:6.1f} Hz", node, as_count(figure->second.value),
                    figure->second.unit, (figure->second.value - value_of(before, name)) / seconds);
    if (const auto force = find_value(now, "last_second_max_force_n"))
      line += fmt::format("  force {:6.2f} N at most", *force);
    if (const auto share = find_value(now, "last_second_answered_share"))
      line += fmt::format("  answered {:5.1f} %", 100.0 * *share);
    return line;
  }
  return {};
}

}  // namespace voxtouch::runtime
