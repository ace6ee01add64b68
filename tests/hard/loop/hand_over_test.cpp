// Hard case L6: a loop that overruns its cycle, and a pose that is read while it is written.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>

#include "core/types/latest_value.hpp"
#include "nodes/runtime/clock.hpp"

namespace voxtouch::runtime {
namespace {

/// As large as a pose and its twist; all numbers of one sample are the same.
using Sample = std::array<std::uint64_t, 13>;

TEST(HardCaseL6, PosesAreNeverTornAndTimeNeverRunsBack) {
  // The writer continues until the reader has received enough: on a busy machine it might end
  // before a read starts.
  constexpr std::uint64_t kSamples = 2'000'000;
  constexpr std::uint64_t kReads = 100;
  LatestValue<Sample> latest;
  std::atomic<bool> enough{false};
  std::thread writer([&] {
    Sample sample;
    for (std::uint64_t i = 1; !enough.load(std::memory_order_relaxed); ++i) {
      sample.fill(i);
      latest.put(sample);
    }
  });
  std::uint64_t torn = 0, backwards = 0, read = 0, last = 0;
  while (last < kSamples || read < kReads) {
    Sample sample;
    if (!latest.take(sample))
      continue;
    ++read;
    for (const std::uint64_t value : sample)
      torn += value != sample[0];
    backwards += sample[0] <= last;
    last = sample[0];
  }
  enough.store(true, std::memory_order_relaxed);
  writer.join();
  EXPECT_EQ(torn, 0U);
  EXPECT_EQ(backwards, 0U);
}

TEST(HardCaseL6, OverrunIsCountedAndTheGridIsKept) {
  constexpr std::int64_t kPeriod = 1'000'000;
  std::int64_t deadline = 5 * kPeriod;
  std::uint64_t skipped = 0;
  // Cycles that end 0.2, 0.9, 3.4, 0.1, 1.05 periods after their deadline.
  for (const double elapsed : {0.2, 0.9, 3.4, 0.1, 1.05}) {
    const Deadline next =
        next_deadline(deadline, deadline + static_cast<std::int64_t>(elapsed * kPeriod), kPeriod);
    EXPECT_EQ(next.at_ns % kPeriod, 0) << "no drift";
    EXPECT_GT(next.at_ns, deadline + static_cast<std::int64_t>(elapsed * kPeriod) - kPeriod)
        << "no burst to catch up";
    skipped += next.skipped;
    deadline = next.at_ns;
  }
  EXPECT_EQ(skipped, 4U) << "three periods and one";
}

}  // namespace
}  // namespace voxtouch::runtime
