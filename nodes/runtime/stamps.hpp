#pragma once
/// Sums and differences of received time stamps. Any 64-bit value may be a stamp, so the functions
/// never overflow. Real-time safe.
#include <cstdint>

namespace voxtouch::runtime {

/// From `earlier` to `later` [ns]; wraps if the difference exceeds 64 bits (292 years).
inline std::int64_t ns_between(std::int64_t earlier, std::int64_t later) noexcept {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(later) -
                                   static_cast<std::uint64_t>(earlier));
}
/// The same in seconds.
inline double seconds_between(std::int64_t earlier, std::int64_t later) noexcept {
  return static_cast<double>(ns_between(earlier, later)) * 1e-9;
}
/// `stamp` plus `ns` >= 0, saturated at the largest stamp.
inline std::int64_t ns_after(std::int64_t stamp, std::int64_t ns) noexcept {
  std::int64_t sum = 0;
  return __builtin_add_overflow(stamp, ns, &sum) ? INT64_MAX : sum;
}

}  // namespace voxtouch::runtime
