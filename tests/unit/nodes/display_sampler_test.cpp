// Which samples of a loop are shown: a hundred a second, also of a loop that is often late.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <vector>

#include "nodes/runtime/display_sampler.hpp"
#include "tests/support/seed.hpp"

namespace voxtouch::runtime {
namespace {

/// Counts by stamps: for loops at 1 kHz and at 700 Hz, and for one that is often late and stalls
/// for up to 90 ms.
TEST(DisplaySampler, SamplesALateLoopAtAHundredHertz) {
  for (const double rate_hz : {1000.0, 700.0, 120.0}) {
    DisplaySampler regular;
    std::mt19937_64 random(voxtouch::testing::seed(19));
    std::vector<std::int64_t> stamps;
    std::int64_t late_from = 6'000'000'000, late_until = late_from;
    for (std::int64_t n = 0; n < static_cast<std::int64_t>(30.0 * rate_hz); ++n) {
      const std::int64_t now =
          5'000'000'000 + static_cast<std::int64_t>(1e9 * static_cast<double>(n) / rate_hz);
      if (rate_hz > 500.0 && now >= late_from) {
        late_until = now + static_cast<std::int64_t>(random() % 90'000'000);
        late_from = late_until + 300'000'000 + static_cast<std::int64_t>(random() % 1'000'000'000);
      }
      if (now < late_until)
        continue;  // a sample that was never answered
      if (regular.is_due(now))
        stamps.push_back(now);
    }
    const double span_s = 1e-9 * static_cast<double>(stamps.back() - stamps.front());
    EXPECT_NEAR(static_cast<double>(stamps.size() - 1) / span_s, 100.0, 0.1) << rate_hz;
    EXPECT_TRUE(std::ranges::is_sorted(stamps, std::less_equal<>())) << "one was shown twice";
  }
  DisplaySampler regular;
  EXPECT_TRUE(regular.is_due(5'000'000'000));
  int made_up = 0;
  for (std::int64_t now = 15'000'000'000; now < 15'010'000'000; now += 100'000)
    made_up += regular.is_due(now);
  EXPECT_EQ(made_up, 1) << "ten seconds of nothing are not made up for";
}

TEST(DisplaySampler, RestartsWithANewSessionsTime) {
  DisplaySampler regular;
  for (int session = 0; session < 2; ++session) {
    int shown = 0;
    for (std::int64_t now = 0; now < 1'000'000'000; now += 1'000'000)
      shown += regular.is_due(now);
    EXPECT_EQ(shown, 100) << session;
  }
}

}  // namespace
}  // namespace voxtouch::runtime
