#include "nodes/runtime/status_line.hpp"

#include <array>

#include <fmt/format.h>

#include "nodes/console/log.hpp"

namespace voxtouch::runtime {

std::string status_line(const std::string& node, const Figures& now, const Figures& before,
                        double seconds) {
  // Figure names of the nodes for their samples.
  constexpr std::array kCounted{"samples", "checked", "received"};
  for (const char* const name : kCounted) {
    const auto figure = now.find(name);
    if (figure == now.end() || figure->second.value <= 0.0)
      continue;
    std::string line =
        fmt::format("{}: {:>7} {} at {:6.1f} Hz", node, as_count(figure->second.value),
                    figure->second.unit, (figure->second.value - value_of(before, name)) / seconds);
    if (const auto force = find_value(now, "last_second_max_force_n"))
      line += fmt::format("  force {:6.2f} N at most", *force);
    if (const auto fraction = find_value(now, "last_second_answered_ratio"))
      line += fmt::format("  answered {:5.1f} %", 100.0 * *fraction);
    return line;
  }
  return {};
}

void RateLine::print(std::int64_t now_ns, const Figures& figures) {
  if (!enabled_ || now_ns - last_ns_ < 1'000'000'000)
    return;
  const std::string line =
      status_line(node_, figures, last_, 1e-9 * static_cast<double>(now_ns - last_ns_));
  if (last_ns_ != 0 && !line.empty())
    console::log("{}\n", line);
  last_ = figures, last_ns_ = now_ns;
}

}  // namespace voxtouch::runtime
