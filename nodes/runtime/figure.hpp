#pragma once
/// Numbers that a node reports about itself. They remain numbers on the wire.
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace voxtouch::runtime {

struct Figure {
  Figure() = default;
  template <class Number>
  requires std::is_arithmetic_v<Number> Figure(Number measured, std::string of)
      : value(static_cast<double>(measured)),
        unit(std::move(of)) {}
  double value = 0.0;
  std::string unit;  ///< Hz, us, N, ..., or the counted objects: samples, messages
};
using Figures = std::map<std::string, Figure, std::less<>>;

/// Converts a received figure to a count. NaN gives 0; larger values give the largest integer that
/// a double holds exactly.
inline std::uint64_t as_count(double value) noexcept {
  constexpr double kMaxWhole = 9007199254740992.0;  // 2^53
  return value > 0.0 ? static_cast<std::uint64_t>(value < kMaxWhole ? value : kMaxWhole)
                     : 0;  // NaN compares false
}

inline std::optional<double> find_value(const Figures& figures, std::string_view name) {
  const auto found = figures.find(name);
  return found == figures.end() ? std::nullopt : std::optional(found->second.value);
}
/// 0 if there is no figure of that name.
inline double value_of(const Figures& figures, std::string_view name) {
  return find_value(figures, name).value_or(0.0);
}

}  // namespace voxtouch::runtime
