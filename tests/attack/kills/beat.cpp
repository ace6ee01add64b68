#include "tests/attack/kills/beat.hpp"

#include <pthread.h>
#include <time.h>

namespace voxtouch::attack {

std::int64_t monotonic_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
}

Beat::Beat()
    : thread_([this] {
        const sched_param urgent{.sched_priority = 80};
        pthread_setschedparam(pthread_self(), SCHED_FIFO, &urgent);  // as the ring's; where it is not granted, neither is theirs
        constexpr std::int64_t kPeriodNs = 1'000'000;
        std::int64_t due_ns = monotonic_ns() + kPeriodNs;
        while (!stop_.load()) {
          const timespec at{due_ns / 1'000'000'000, due_ns % 1'000'000'000};
          clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr);
          const std::int64_t now_ns = monotonic_ns(), late_ns = now_ns - due_ns;
          if (late_ns > longest_ns_.load()) longest_ns_.store(late_ns);
          due_ns = now_ns + kPeriodNs;
        }
      }) {}

Beat::~Beat() {
  stop_.store(true);
  thread_.join();
}

}  // namespace voxtouch::attack
