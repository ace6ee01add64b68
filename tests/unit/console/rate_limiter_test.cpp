#include "nodes/console/rate_limiter.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace voxtouch::console {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(RateLimiter, PrintsTheFirstOfEachSecondAndCountsTheRest) {
  RateLimiter few(3);
  int printed = 0;
  std::uint64_t skipped = 0;
  std::vector<std::int64_t> reported_ms;
  for (std::int64_t ms = 5000; ms < 15'000; ++ms) {  // ten seconds, a text a millisecond
    const auto verdict = few.take(ms * kMs);
    printed += verdict.print;
    skipped += verdict.skipped;
    if (verdict.skipped > 0)
      reported_ms.push_back(ms);
  }
  EXPECT_EQ(printed, 30);
  EXPECT_EQ(skipped, 9U * 997U) << "of the last second is reported when there is a later one";
  EXPECT_EQ(reported_ms.size(), 9U);
  EXPECT_EQ(few.take(60'000 * kMs).skipped, 997U);
  EXPECT_EQ(few.take(61'000 * kMs).skipped, 0U);
}

TEST(RateLimiter, LosesNoCountBetweenThreads) {
  RateLimiter few(2);
  std::atomic<int> printed{0};
  std::vector<std::thread> threads;
  for (int n = 0; n < 4; ++n)
    threads.emplace_back([&] {
      for (int i = 0; i < 10'000; ++i)
        printed += few.take(7 * kMs).print;
    });
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(printed, 2);
  EXPECT_EQ(few.take(2000 * kMs).skipped, 39'998U);
}

}  // namespace
}  // namespace voxtouch::console
