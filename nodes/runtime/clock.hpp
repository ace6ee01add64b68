#pragma once
/// Clocks of the nodes. core and devices receive the time as an argument.
#include <cstdint>

namespace voxtouch::runtime {

/// Monotonic time, for deadlines and latencies [ns].
std::int64_t monotonic_ns() noexcept;
/// Time since 1970, for stamps that leave the process in real time [ns].
std::int64_t realtime_ns() noexcept;
/// Sleeps until `deadline_ns` of the monotonic clock. Real-time safe.
void sleep_until(std::int64_t deadline_ns) noexcept;

/// The next deadline on the period grid after `now_ns`, and the number of skipped periods. A late
/// loop skips periods and does not catch up.
struct Deadline {
  std::int64_t at_ns = 0;
  std::uint64_t skipped = 0;
};
/// All times are of the monotonic clock. Real-time safe.
Deadline next_deadline(std::int64_t previous_ns, std::int64_t now_ns,
                       std::int64_t period_ns) noexcept;

}  // namespace voxtouch::runtime
