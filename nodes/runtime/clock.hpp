#pragma once
/// Clocks of the nodes. core and devices have none: time is given to them.
#include <cstdint>

namespace voxtouch::runtime {

/// Never steps back; for deadlines and latencies [ns].
std::int64_t monotonic_ns() noexcept;
/// Since 1970; for stamps that leave the process in real time [ns].
std::int64_t realtime_ns() noexcept;
/// Sleeps until `deadline_ns` of the monotonic clock. Real-time safe.
void sleep_until(std::int64_t deadline_ns) noexcept;

/// The next deadline on the grid of periods that is still ahead of `now_ns`, and how many were
/// skipped on the way there: a late loop drops periods, it never hurries to catch up.
struct Deadline {
  std::int64_t at_ns = 0;
  std::uint64_t skipped = 0;
};
/// All by the monotonic clock. Real-time safe.
Deadline next_deadline(std::int64_t previous_ns, std::int64_t now_ns,
                       std::int64_t period_ns) noexcept;

}  // namespace voxtouch::runtime
