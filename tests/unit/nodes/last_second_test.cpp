// The status line that `up` prints once a second, about that second.
#include "nodes/device/last_second.hpp"

#include <gtest/gtest.h>

namespace voxtouch::device_node {
namespace {

TEST(LastSecond, HoldsTheLargestForceForExactlyASecond) {
  LastSecond last;
  for (int ms = 0; ms <= 3000; ms += 20) {
    const bool touches = ms == 1000;
    last.poll(ms * 1'000'000LL, static_cast<std::uint64_t>(ms), static_cast<std::uint64_t>(ms),
              touches ? 0.32 : 0.0);
    EXPECT_EQ(last.largest_force_n(), ms >= 1000 && ms < 2000 ? 0.32 : 0.0) << ms;
  }
}

TEST(LastSecond, CountsTheRatioAnsweredInIt) {
  LastSecond last;
  EXPECT_EQ(last.answered_ratio(), 1.0);
  std::uint64_t samples = 0, answered = 0;
  for (int ms = 0; ms <= 4000; ms += 20) {
    last.poll(ms * 1'000'000LL, samples, answered, 0.0);
    if (ms == 2000) {
      EXPECT_EQ(last.answered_ratio(), 1.0);
    }
    if (ms == 3000) {
      EXPECT_EQ(last.answered_ratio(), 0.5);
    }
    if (ms == 4000) {
      EXPECT_EQ(last.answered_ratio(), 0.0);
    }
    samples += 20;
    answered += ms < 2000 ? 20U : ms < 3000 ? 10U : 0U;
  }
}

}  // namespace
}  // namespace voxtouch::device_node
