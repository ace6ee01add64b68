// Hanging nodes, and nodes that were only not polled, with clocks that the test sets.
#include "nodes/runtime/heartbeat.hpp"

#include <gtest/gtest.h>

namespace voxtouch::runtime {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(StallWatch, CountsFromTheLastChangeOn) {
  WatchClock clock;
  StallWatch watch;
  for (int ms = 0; ms <= 1000; ms += 20) {
    clock.poll(5'000'000'000 + ms * kMs);
    const std::uint64_t sign = ms < 500 ? static_cast<std::uint64_t>(ms) : 500U;
    EXPECT_EQ(watch.stalled_ns(sign, clock), ms < 500 ? 0 : (ms - 500) * kMs) << ms;
  }
}

TEST(StallWatch, IgnoresTimeInWhichItDidNotRun) {
  WatchClock clock;
  StallWatch watch;
  clock.poll(0);
  EXPECT_EQ(watch.stalled_ns(7, clock), 0);
  clock.poll(20 * kMs);
  clock.poll(3'000 * kMs);  // stopped itself
  EXPECT_LE(watch.stalled_ns(7, clock), 120 * kMs);
  for (int n = 1; n <= 15; ++n)
    clock.poll((3'000 + 20 * n) * kMs);
  EXPECT_GT(watch.stalled_ns(7, clock), kHungNs) << "but now it has looked long enough";
}

TEST(Heartbeat, ChangesWithEveryCycleAndWhileBusy) {
  Heartbeat loop;
  const std::uint64_t first = loop.sign();
  EXPECT_EQ(loop.sign(), first) << "it has not turned";
  loop.beat();
  EXPECT_NE(loop.sign(), first);
  {
    const Heartbeat::Busy busy(loop, 60'000 * kMs);
    const std::uint64_t working = loop.sign();
    EXPECT_NE(loop.sign(), working);
  }
  const std::uint64_t after = loop.sign();
  EXPECT_EQ(loop.sign(), after);
  {
    const Heartbeat::Busy over(loop, 0);
    const std::uint64_t working = loop.sign();
    EXPECT_EQ(loop.sign(), working) << "it took longer than it may";
  }
}

}  // namespace
}  // namespace voxtouch::runtime
