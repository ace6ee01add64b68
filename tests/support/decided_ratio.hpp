#pragma once
/// Ratio of samples that the validation decides.
#include "core/reference/contact_validator.hpp"

namespace voxtouch::test {

/// At least this ratio of the checked samples should be decided; otherwise a run is not conclusive.
inline constexpr double kMinDecidedRatio = 0.2;

/// 0 before the first sample.
inline double decided_ratio(const reference::ValidationCounts& counts) noexcept {
  return counts.checked > 0
             ? static_cast<double>(counts.decided) / static_cast<double>(counts.checked)
             : 0.0;
}

}  // namespace voxtouch::test
