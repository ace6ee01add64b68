#include "nodes/runtime/parallel_for.hpp"
#include "nodes/runtime/realtime.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace voxtouch::runtime {
namespace {

TEST(ThreadedFor, CallsTheBodyOncePerIndexForAnyThreads) {
  for (const std::size_t threads : {0U, 1U, 2U, 3U, 8U, 100U})
    for (const std::size_t count : {0U, 1U, 2U, 7U, 1000U}) {
      std::vector<std::atomic<int>> calls(count);
      threaded_for(threads)(count, [&](std::size_t i) { ++calls.at(i); });
      for (const auto& n : calls)
        ASSERT_EQ(n, 1) << threads << " threads, " << count;
    }
}

/// Each waits until the other has begun, which one thread alone could not.
TEST(ThreadedFor, RunsAsManyAtOnceAsItHasThreads) {
  std::atomic<int> begun{0};
  threaded_for(2)(2, [&](std::size_t) {
    ++begun;
    while (begun < 2)
      std::this_thread::yield();
  });
  EXPECT_EQ(begun, 2);
}

TEST(ThreadedFor, RethrowsTheLowestIndexAndStaysUsable) {
  for (int round = 0; round < 200; ++round) {
    const ParallelFor loop = threaded_for(4);
    try {
      loop(100, [](std::size_t i) {
        if (i >= 20)
          throw std::runtime_error(std::to_string(i));
      });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "20");
    }
    std::atomic<int> calls{0};
    loop(10, [&](std::size_t) { ++calls; });
    EXPECT_EQ(calls, 10);
  }
}

TEST(ThreadedFor, TakesNoRealTimePriorityFromItsCaller) {
  std::set<int> policies;
  bool real_time = false;
  std::thread([&] {
    sched_param parameters{};
    parameters.sched_priority = 1;
    real_time = sched_setscheduler(0, SCHED_FIFO, &parameters) == 0;
    std::mutex mutex;
    threaded_for(3)(30, [&](std::size_t) {
      const std::lock_guard lock(mutex);
      policies.insert(sched_getscheduler(0));
    });
  }).join();
  if (!real_time)
    GTEST_SKIP() << "SCHED_FIFO is not allowed here";
  EXPECT_EQ(policies, std::set<int>{SCHED_OTHER});
}

TEST(AtOrdinaryPriority, GivesBackWhatTheThreadHad) {
  int before = -1, within = -1, of_started = -1, after = -1, priority = -1;
  bool real_time = false;
  std::thread([&] {
    const sched_param parameters{.sched_priority = 7};
    real_time = sched_setscheduler(0, SCHED_FIFO, &parameters) == 0;
    before = sched_getscheduler(0);
    {
      const AtOrdinaryPriority meanwhile;
      within = sched_getscheduler(0);
      std::thread([&] { of_started = sched_getscheduler(0); }).join();
    }
    after = sched_getscheduler(0);
    sched_param had{};
    sched_getparam(0, &had);
    priority = had.sched_priority;
  }).join();
  EXPECT_EQ(within, SCHED_OTHER);
  EXPECT_EQ(of_started, SCHED_OTHER);
  EXPECT_EQ(after, before);
  EXPECT_EQ(priority, real_time ? 7 : 0);
}

}  // namespace
}  // namespace voxtouch::runtime
