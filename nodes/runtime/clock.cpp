#include "nodes/runtime/clock.hpp"

#include <cerrno>
#include <ctime>

namespace voxtouch::runtime {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

std::int64_t read(clockid_t clock) noexcept {
  timespec t{};
  clock_gettime(clock, &t);
  return t.tv_sec * kSecond + t.tv_nsec;
}

}  // namespace

std::int64_t monotonic_ns() noexcept { return read(CLOCK_MONOTONIC); }
std::int64_t realtime_ns() noexcept { return read(CLOCK_REALTIME); }

void sleep_until(std::int64_t deadline_ns) noexcept {
  const timespec t{deadline_ns / kSecond, deadline_ns % kSecond};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

Deadline next_deadline(std::int64_t previous_ns, std::int64_t now_ns,
                       std::int64_t period_ns) noexcept {
  const std::int64_t next = previous_ns + period_ns;
  if (now_ns <= next)
    return {next, 0};
  const std::int64_t skipped = (now_ns - next) / period_ns + 1;
  return {next + skipped * period_ns, static_cast<std::uint64_t>(skipped)};
}

}  // namespace voxtouch::runtime
