#include "nodes/log/few_a_second.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace voxtouch::log {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(FewASecond, SaysTheFirstOfEachSecondAndCountsTheOthersOnce) {
  FewASecond few(3);
  int said = 0;
  std::uint64_t left_out = 0;
  std::vector<std::int64_t> told_ms;
  for (std::int64_t ms = 5000; ms < 15'000; ++ms) {  // ten seconds, a text a millisecond
    const auto verdict = few.take(ms * kMs);
    said += verdict.say;
    left_out += verdict.left_out;
    if (verdict.left_out > 0)
      told_ms.push_back(ms);
  }
  EXPECT_EQ(said, 30);
  EXPECT_EQ(left_out, 9U * 997U) << "of the last second is told when there is a later one";
  EXPECT_EQ(told_ms.size(), 9U);
  EXPECT_EQ(few.take(60'000 * kMs).left_out, 997U);
  EXPECT_EQ(few.take(61'000 * kMs).left_out, 0U);
}

TEST(FewASecond, LosesNoCountBetweenThreads) {
  FewASecond few(2);
  std::atomic<int> said{0};
  std::vector<std::thread> threads;
  for (int n = 0; n < 4; ++n)
    threads.emplace_back([&] {
      for (int i = 0; i < 10'000; ++i)
        said += few.take(7 * kMs).say;
    });
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(said, 2);
  EXPECT_EQ(few.take(2000 * kMs).left_out, 39'998U);
}

}  // namespace
}  // namespace voxtouch::log
