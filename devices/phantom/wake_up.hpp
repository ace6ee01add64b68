#pragma once
/// Wakes a waiting thread from a thread that must not block.
#include <semaphore.h>
#include <time.h>

#include <cerrno>
#include <chrono>
#include <cstdint>

namespace voxtouch::phantom {

/// A POSIX semaphore: posting is one atomic operation, and a system call only if a thread waits.
/// Check the condition first, then wait; a wait may end without a change.
class WakeUp {
 public:
  WakeUp() noexcept { sem_init(&semaphore_, 0, 0); }
  ~WakeUp() { sem_destroy(&semaphore_); }
  WakeUp(const WakeUp&) = delete;
  WakeUp& operator=(const WakeUp&) = delete;

  void post() noexcept { sem_post(&semaphore_); }
  /// Discards posts whose cause has been handled.
  void clear() noexcept {
    while (sem_trywait(&semaphore_) == 0) {
    }
  }
  /// Returns false if `deadline` passed without a post.
  bool wait_until(std::chrono::steady_clock::time_point deadline) noexcept {
    const std::int64_t ns = std::chrono::nanoseconds(deadline.time_since_epoch()).count();
    const timespec at{static_cast<time_t>(ns / 1'000'000'000),
                      static_cast<long>(ns % 1'000'000'000)};
    while (sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &at) != 0)
      if (errno != EINTR)
        return false;
    return true;
  }

 private:
  sem_t semaphore_;
};

}  // namespace voxtouch::phantom
