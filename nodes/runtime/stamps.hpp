#pragma once
/// Sums and differences of stamps that came over the network: any 64 bits are a stamp, and none of
/// them may overflow. Real-time safe.
#include <cstdint>

namespace voxtouch::runtime {

/// From `earlier` to `later` [ns]; wraps where the difference does not fit (292 years), as the bits
/// do.
inline std::int64_t ns_between(std::int64_t earlier, std::int64_t later) noexcept {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(later) -
                                   static_cast<std::uint64_t>(earlier));
}
/// The same in seconds.
inline double seconds_between(std::int64_t earlier, std::int64_t later) noexcept {
  return static_cast<double>(ns_between(earlier, later)) * 1e-9;
}
/// `stamp` and `ns` >= 0 on; the last stamp there is where the sum is beyond it.
inline std::int64_t ns_after(std::int64_t stamp, std::int64_t ns) noexcept {
  std::int64_t sum = 0;
  return __builtin_add_overflow(stamp, ns, &sum) ? INT64_MAX : sum;
}

}  // namespace voxtouch::runtime
