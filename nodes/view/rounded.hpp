#pragma once
/// Numbers for the page.
#include <cmath>

#include <nlohmann/json.hpp>

namespace voxtouch::view {

/// Rounds to six digits, enough for display. NaN and infinity become null, since JSON has neither.
inline nlohmann::json rounded(double value) {
  if (!std::isfinite(value))
    return nullptr;
  if (value == 0.0)
    return 0;
  const double unit = std::pow(10.0, 5.0 - std::floor(std::log10(std::abs(value))));
  return std::isfinite(unit) ? std::round(value * unit) / unit : value;
}

}  // namespace voxtouch::view
