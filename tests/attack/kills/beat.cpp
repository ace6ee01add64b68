#include "tests/attack/kills/beat.hpp"

#include <pthread.h>
#include <sched.h>
#include <time.h>

#include <algorithm>

namespace voxtouch::attack {
namespace {

std::int64_t now_ns(clockid_t clock) noexcept {
  timespec now{};
  clock_gettime(clock, &now);
  return std::int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
}

void note_delays_on(std::size_t cpu, const std::atomic<bool>& stop,
                    std::atomic<std::int64_t>& longest_ns) {
  cpu_set_t only;
  CPU_ZERO(&only);
  CPU_SET(cpu, &only);
  pthread_setaffinity_np(pthread_self(), sizeof only, &only);
  const sched_param urgent{.sched_priority = 80};
  pthread_setschedparam(pthread_self(), SCHED_FIFO,
                        &urgent);  // as the ring's nodes; if refused, they do not have it either
  constexpr std::int64_t kPeriodNs = 1'000'000;
  std::int64_t due_ns = now_ns(CLOCK_MONOTONIC) + kPeriodNs;
  while (!stop.load()) {
    const timespec at{due_ns / 1'000'000'000, due_ns % 1'000'000'000};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr);
    const std::int64_t woken_ns = now_ns(CLOCK_MONOTONIC), late_ns = woken_ns - due_ns;
    if (late_ns > longest_ns.load())
      longest_ns.store(late_ns);
    due_ns = woken_ns + kPeriodNs;
  }
}

}  // namespace

std::int64_t unix_ns() noexcept { return now_ns(CLOCK_REALTIME); }

Beats::Beats() : longest_ns_(std::max(1U, std::thread::hardware_concurrency())) {
  for (std::size_t cpu = 0; cpu < longest_ns_.size(); ++cpu)
    threads_.emplace_back([this, cpu] { note_delays_on(cpu, stop_, longest_ns_[cpu]); });
}

Beats::~Beats() {
  stop_.store(true);
  for (std::thread& thread : threads_)
    thread.join();
}

void Beats::restart() noexcept {
  for (std::atomic<std::int64_t>& longest : longest_ns_)
    longest.store(0);
}

std::int64_t Beats::longest_ns() const noexcept {
  std::int64_t longest_ns = 0;
  for (const std::atomic<std::int64_t>& of_one : longest_ns_)
    longest_ns = std::max(longest_ns, of_one.load());
  return longest_ns;
}

}  // namespace voxtouch::attack
